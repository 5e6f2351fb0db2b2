// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "support/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "unit/core/detail/lane_packing_test.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** Numbers of the lanes that packing by a mask of bits stores, once as floats, once as integers. */
std::size_t packLanes(std::uint32_t bits, float* floats, std::uint32_t* integers) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto lane = hn::Iota(du, 0);
  const auto chosen = hn::TestBit(hn::Set(du, bits), hn::Shl(hn::Set(du, 1u), lane));
  const LanePacking packing(d, hn::RebindMask(d, chosen));
  packing.store(hn::Iota(d, 0.0f), floats);
  packing.store(lane, integers);
  return packing.count();
}

std::size_t numLanes() {
  return hn::Lanes(hn::CappedTag<float, 16>());
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(packLanes);
HWY_EXPORT(numLanes);

TEST(LanePacking, PutsTheLanesOfEveryMaskInOrder) {
  pcl_slim_test::forEachInstructionSet([](const char* name) {
    SCOPED_TRACE(name);
    const std::size_t lanes = HWY_DYNAMIC_DISPATCH(numLanes)();
    for (std::uint32_t bits = 0; bits < 1u << lanes; ++bits) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        if ((bits >> lane & 1u) != 0) expected.push_back(lane);
      }
      float floats[16];
      std::uint32_t integers[16];
      ASSERT_EQ(HWY_DYNAMIC_DISPATCH(packLanes)(bits, floats, integers), expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(floats[k], static_cast<float>(expected[k])) << bits;
        ASSERT_EQ(integers[k], expected[k]) << bits;
      }
    }
  });
}

}  // namespace pcl_slim::detail::kernels
#endif

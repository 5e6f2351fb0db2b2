// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/center_grid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "grid_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

std::size_t entriesWithin(const float* x, const float* y, const float* z, const ColumnRange* ranges,
                          std::size_t num_ranges, const float place[3], float limit_sq,
                          std::uint32_t* entries, float* distances_sq) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const auto px = Set(d, place[0]), py = Set(d, place[1]), pz = Set(d, place[2]);
  const auto limit = Set(d, limit_sq);
  std::size_t count = 0;
  for (std::size_t r = 0; r < num_ranges; ++r) {
    for (std::size_t i = ranges[r].begin; i < ranges[r].end; i += hn::Lanes(d)) {
      const auto ex = LoadU(d, x + i) - px;
      const auto ey = LoadU(d, y + i) - py;
      const auto ez = LoadU(d, z + i) - pz;
      // Not fused: the same bits for every instruction set.
      const auto distance_sq = ex * ex + ey * ey + ez * ez;
      const auto near = And(distance_sq < limit, FirstN(d, ranges[r].end - i));
      const LanePacking packing(d, near);
      packing.store(distance_sq, distances_sq + count);
      packing.store(Iota(du, static_cast<std::uint32_t>(i)), entries + count);
      count += packing.count();
    }
  }
  return count;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(entriesWithin);
std::size_t entriesWithin(const float* x, const float* y, const float* z, const ColumnRange* ranges,
                          std::size_t num_ranges, const float place[3], float limit_sq,
                          std::uint32_t* entries, float* distances_sq) {
  return HWY_DYNAMIC_DISPATCH(entriesWithin)(x, y, z, ranges, num_ranges, place, limit_sq, entries,
                                             distances_sq);
}

}  // namespace pcl_slim::detail::kernels
#endif

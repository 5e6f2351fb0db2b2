// SPDX-License-Identifier: BSD-3-Clause
// Lanes of a mask side by side. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_COMPRESS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_COMPRESS_INL
#undef PCL_SLIM_COMPRESS_INL
#else
#define PCL_SLIM_COMPRESS_INL
#endif

#include <cstdint>

#include "pcl_slim/surface/detail/kernel_math-inl.h"

#ifndef PCL_SLIM_LANES_TO_FRONT
#define PCL_SLIM_LANES_TO_FRONT
namespace pcl_slim::detail::kernels {

/** For each mask of eight lanes the lanes that it holds, from the first, four bits each. */
struct LanesToFront {
  std::uint32_t packed[256] = {};

  constexpr LanesToFront()
  {
    for (unsigned mask = 0; mask < 256; ++mask) {
      unsigned place = 0;
      for (unsigned lane = 0; lane < 8; ++lane) {
        if ((mask >> lane & 1u) != 0) packed[mask] |= lane << (4 * place++);
      }
    }
  }
};
inline constexpr LanesToFront kLanesToFront;

}  // namespace pcl_slim::detail::kernels
#endif

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2

/** Where the lanes of a mask come from when they are moved to the front. Highway's own Compress
 * keeps its table on the stack, and compilers fill it, a kilobyte, at every call. */
class Compression {
 public:
  HWY_INLINE explicit Compression(Mask mask)
  {
    const hn::RebindToUnsigned<Tag> du;
    alignas(32) static constexpr std::uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
    std::uint8_t bits[8];
    hn::StoreMaskBits(Tag(), mask, bits);
    const auto packed = hn::Set(du, kLanesToFront.packed[bits[0]]);
    from_ = hn::And(hn::Shr(packed, hn::Load(du, kShifts)), hn::Set(du, 7u));
  }
  HWY_INLINE Vec operator()(Vec v) const
  {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(Tag(), from_));
  }

 private:
  hn::Vec<hn::RebindToUnsigned<Tag>> from_;
};

#else

class Compression {
 public:
  HWY_INLINE explicit Compression(Mask mask) : mask_(mask) {}
  HWY_INLINE Vec operator()(Vec v) const { return hn::Compress(v, mask_); }

 private:
  Mask mask_;
};

#endif

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Moves the lanes of a mask to the front. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_LANE_PACKING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LANE_PACKING_INL
#undef PCL_SLIM_LANE_PACKING_INL
#else
#define PCL_SLIM_LANE_PACKING_INL
#endif

#include <cstdint>

#include "hwy/highway.h"

#ifndef PCL_SLIM_PACKED_LANES
#define PCL_SLIM_PACKED_LANES
namespace pcl_slim::detail::kernels {

/** For each mask of up to eight lanes, the indices of its lanes in order. */
struct PackedLanes {
  std::uint8_t lanes[256][8] = {};

  constexpr PackedLanes() {
    for (unsigned mask = 0; mask < 256; ++mask) {
      unsigned place = 0;
      for (unsigned lane = 0; lane < 8; ++lane) {
        if ((mask >> lane & 1u) != 0) lanes[mask][place++] = static_cast<std::uint8_t>(lane);
      }
    }
  }
};
inline constexpr PackedLanes kPackedLanes;

}  // namespace pcl_slim::detail::kernels
#endif

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3 || \
    HWY_TARGET == HWY_NEON

/** Where the lanes of a mask come from. hn::Compress reads these numbers from a local table, which
 * compilers copy onto the stack at every call (1 KB on AVX2); this table is static. */
template <class D>
class LaneOrder {
 public:
  HWY_INLINE LaneOrder(D d, hn::Mask<D> mask) {
    std::uint8_t bits[8];
    StoreMaskBits(d, mask, bits);
    const auto lanes = LoadU(hn::Rebind<std::uint8_t, D>(), kPackedLanes.lanes[bits[0]]);
    from_ = PromoteTo(hn::RebindToUnsigned<D>(), lanes);
  }
  template <class V>
  HWY_INLINE V pack(V v) const {
    return TableLookupLanes(v, IndicesFromVec(hn::DFromV<V>(), from_));
  }

 private:
  hn::Vec<hn::RebindToUnsigned<D>> from_;
};

#else

template <class D>
class LaneOrder {
 public:
  HWY_INLINE LaneOrder(D, hn::Mask<D> mask) : mask_(mask) {}
  template <class V>
  HWY_INLINE V pack(V v) const {
    return Compress(v, RebindMask(hn::DFromV<V>(), mask_));
  }

 private:
  hn::Mask<D> mask_;
};

#endif

/** Packs the lanes of one mask, of any number of columns of 32-bit values. */
template <class D>
class LanePacking {
 public:
  HWY_INLINE LanePacking(D d, hn::Mask<D> mask) : mask_(mask), order_(d, mask) {}

  /** Stores a whole vector, the mask's lanes first: columns are padded for it. (Compressing
   * straight to memory is microcoded on some processors.) */
  template <class V>
  HWY_INLINE void store(V v, hn::TFromV<V>* target) const {
    StoreU(order_.pack(v), hn::DFromV<V>(), target);
  }

  HWY_INLINE std::size_t count() const { return CountTrue(D(), mask_); }

 private:
  hn::Mask<D> mask_;
  LaneOrder<D> order_;
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

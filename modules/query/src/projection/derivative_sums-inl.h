// SPDX-License-Identifier: BSD-3-Clause
// Sums of second and third derivatives over leaves (equation 8, left), turned from a leaf's frame
// to the block's axes. The guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_DERIVATIVE_SUMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_DERIVATIVE_SUMS_INL
#undef PCL_SLIM_DERIVATIVE_SUMS_INL
#else
#define PCL_SLIM_DERIVATIVE_SUMS_INL
#endif

#include "projection/leaf_frame-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** Adds the lanes of mask; 0 to the others, whatever value is there. */
HWY_INLINE void
addTo(float* target, Mask mask, Vec value)
{
  const Tag d;
  hn::Store(hn::Add(hn::Load(d, target), hn::IfThenElseZero(mask, value)), d, target);
}

/** Adds scale times the Hessian H = huu u u^T + huv (u v^T + v u^T) + hvv v v^T. */
template <int D>
HWY_INLINE void
addHessian(const LeafFrame& frame, const HeightJets<D>& jets, const Local& q, Mask near, Vec scale,
           std::size_t i, BlockSums& sums)
{
  Vec huu, huv, hvv;
  jets.second(q.u, q.v, huu, huv, hvv);
  for (int a = 0; a < 3; ++a) {
    const Vec along_u = hn::MulAdd(huu, frame.axisU(a), hn::Mul(huv, frame.axisV(a)));
    const Vec along_v = hn::MulAdd(huv, frame.axisU(a), hn::Mul(hvv, frame.axisV(a)));
    for (int b = a; b < 3; ++b) {
      const Vec entry = hn::MulAdd(along_u, frame.axisU(b), hn::Mul(along_v, frame.axisV(b)));
      addTo(sums.hessian[kSymmetricEntry[a][b]] + i, near, hn::Mul(scale, entry));
    }
  }
}

/** Adds scale times the third derivatives, turned from the frame's axes to the block's. */
HWY_INLINE void
addThird(const LeafFrame& frame, const ThirdDerivatives& h, Mask near, Vec scale, std::size_t i,
         BlockSums& sums)
{
  for (int a = 0, k = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      const Vec uu = hn::Mul(frame.axisU(a), frame.axisU(b));
      const Vec vv = hn::Mul(frame.axisV(a), frame.axisV(b));
      const Vec uv =
          hn::MulAdd(frame.axisU(a), frame.axisV(b), hn::Mul(frame.axisV(a), frame.axisU(b)));
      const Vec along_u = hn::MulAdd(h.uuu, uu, hn::MulAdd(h.uuv, uv, hn::Mul(h.uvv, vv)));
      const Vec along_v = hn::MulAdd(h.uuv, uu, hn::MulAdd(h.uvv, uv, hn::Mul(h.vvv, vv)));
      for (int c = b; c < 3; ++c, ++k) {
        const Vec entry = hn::MulAdd(along_u, frame.axisU(c), hn::Mul(along_v, frame.axisV(c)));
        addTo(sums.third[k] + i, near, hn::Mul(scale, entry));
      }
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// The pixels of a block as one vector or two, so that what is loaded for a leaf serves many pixels, and
// of two vectors a processor runs both chains of operations side by side. Functions are named as
// Highway's. The guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LANES_INL
#undef PCL_SLIM_LANES_INL
#else
#define PCL_SLIM_LANES_INL
#endif

#include "fast/lanes/pair-inl.h"
#include "fast/lanes/single-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "pcl_slim/surface/weight_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

HWY_INLINE Vec
dot3(const Vec& ax, const Vec& ay, const Vec& az, const Vec& bx, const Vec& by, const Vec& bz)
{
  return MulAdd(ax, bx, MulAdd(ay, by, Mul(az, bz)));
}

/** G at squared relative distances below 1. */
HWY_INLINE Vec
blendWeight(WeightKernel kernel, const Vec& s_sq)
{
  return forKernel(kernel, [&](auto k) HWY_ATTR {
    return byParts([](auto part) HWY_ATTR { return kernelWeight<decltype(k)::value>(part); }, s_sq);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif

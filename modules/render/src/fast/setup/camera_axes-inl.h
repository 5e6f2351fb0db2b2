// SPDX-License-Identifier: BSD-3-Clause
// Points and directions in a camera's axes. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_CAMERA_AXES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_CAMERA_AXES_INL
#undef PCL_SLIM_CAMERA_AXES_INL
#else
#define PCL_SLIM_CAMERA_AXES_INL
#endif

#include "camera/camera_rays.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Vectors in the camera's axes. */
struct Triple {
  Vec x, y, z;
};

HWY_INLINE Vec
dot3(const Triple& a, const Triple& b)
{
  return dot3(a.x, a.y, a.z, b.x, b.y, b.z);
}

HWY_INLINE Triple
axisOf(const float axis[3])
{
  return {hn::Set(Tag(), axis[0]), hn::Set(Tag(), axis[1]), hn::Set(Tag(), axis[2])};
}

/** The camera's axes in registers. */
struct Axes {
  Triple right, up, forward;

  explicit Axes(const FrameView& view)
      : right(axisOf(view.right)), up(axisOf(view.up)), forward(axisOf(view.forward))
  {
  }
  HWY_INLINE Triple turn(const Triple& p) const
  {
    return {dot3(p, right), dot3(p, up), dot3(p, forward)};
  }
};

/** World positions from the camera's, without loss where the camera is far from the origin. */
HWY_INLINE Triple
fromEye(const FrameView& view, Vec x, Vec y, Vec z)
{
  const Triple eye = axisOf(view.eye), rest = axisOf(view.eye_rest);
  return {hn::Sub(hn::Sub(x, eye.x), rest.x), hn::Sub(hn::Sub(y, eye.y), rest.y),
          hn::Sub(hn::Sub(z, eye.z), rest.z)};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

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

/** The camera's axes in registers. */
struct Axes {
  Triple<Vec> right, up, forward;

  explicit Axes(const FrameView& view)
      : right(tripleOf<Vec>(view.right)),
        up(tripleOf<Vec>(view.up)),
        forward(tripleOf<Vec>(view.forward)) {}
  HWY_INLINE Triple<Vec> turn(const Triple<Vec>& p) const {
    return {dot3(p, right), dot3(p, up), dot3(p, forward)};
  }
};

/** World positions from the camera's, without loss where the camera is far from the origin. */
HWY_INLINE Triple<Vec> fromEye(const FrameView& view, Vec x, Vec y, Vec z) {
  const Triple<Vec> eye = tripleOf<Vec>(view.eye), rest = tripleOf<Vec>(view.eye_rest);
  return {x - eye.x - rest.x, y - eye.y - rest.y, z - eye.z - rest.z};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

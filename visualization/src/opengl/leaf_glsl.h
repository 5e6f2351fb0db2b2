// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

/** \brief GLSL of the camera: uniforms and the ray through a fragment. */
extern const char* const kCameraGlsl;
/** \brief GLSL of a leaf: its texels, its polynomial along a ray, and that one's roots. */
extern const char* const kLeafGlsl;

}  // namespace pcl_slim::detail

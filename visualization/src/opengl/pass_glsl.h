// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

/** \brief GLSL of the camera: uniforms and the ray through a fragment. */
extern const char* const kCameraGlsl;
/** \brief GLSL of a leaf: its texels, its polynomial along a ray, and that one's roots. */
extern const char* const kLeafGlsl;

// The passes of a frame, for VTK and for pages (web/bundle.mjs reads them). They take the numbers of
// FrameConstant by name, and slimTexel() and slimTrimWord() from whoever stores the surface.
extern const char* const kSurfel;     ///< vertex: what a surfel counts for, where its trim map is
extern const char* const kTrims;      ///< lookup in trim maps
extern const char* const kFirstPass;  ///< first hits
extern const char* const kBlended;    ///< what the next two have in common
extern const char* const kBlendPass;  ///< sums over the leaves at a first hit
extern const char* const kLeafPass;   ///< the leaf of the largest weight
extern const char* const kColorPass;  ///< sums of colours over the leaves at the blend
extern const char* const kSums;       ///< a pixel's sums, and whether its leaves cover the blend
extern const char* const kResult;     ///< normal, depth and curvatures of the sums
extern const char* const kPeel;       ///< where uncovered rays begin once more

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// Texts of shaders that draw a surface, and the shaders that are made of them.
#pragma once

#include <string>

namespace pcl_slim::detail {

/** \brief GLSL of the camera: uniforms and the ray through a fragment. */
extern const char* const kCameraGlsl;
/** \brief GLSL of a leaf: its texels, its polynomial along a ray, and that one's roots. */
extern const char* const kLeafGlsl;

// The passes of a frame, for VTK and for pages (web/bundle.cmake reads them). They take the numbers
// of FrameConstant by name, and slimTexel(), slimTrimWord() and slimTextureTexel() (0..255) from
// whoever stores the surface.
extern const char* const kSurfel;     ///< vertex: what a surfel counts for, where its trim map is
extern const char* const kTrims;      ///< lookup in trim maps
extern const char* const kFirstPass;  ///< first hits
extern const char* const kBlended;    ///< what the next two have in common
extern const char* const kBlendPass;  ///< sums over the leaves at a first hit
extern const char* const kLeafPass;   ///< the leaf of the largest weight
extern const char* const kSums;       ///< a pixel's sums, and whether its leaves cover the blend
extern const char* const kResult;     ///< normal, depth and curvatures of the sums
extern const char* const kPeel;       ///< where uncovered rays begin once more

// Of these kColors comes first, then one of the next two.
extern const char* const kColors;         ///< a leaf's colour by its polynomial
extern const char* const kPlainColors;    ///< surfaces without textures
extern const char* const kTextureColors;  ///< surfaces with textures
extern const char* const kColorPass;      ///< sums of colours over the leaves at the blend

// The passes of Ohtake, Belyaev, Alexa 2005, section 3, in GLSL 1.50, each leaf a rectangle around
// its ball and each pixel a ray. The rules are those of the reference rasteriser, in float.

/** \brief Vertices of a leaf's rectangle, the leaf being the instance. */
std::string leafVertexShader();
/** \brief Vertices of the whole frame. */
std::string frameVertexShader();

/** \brief Pass 1: depth of a leaf's first root inside its shrunk ball, for blending by minimum. */
std::string firstPassShader();
/** \brief Pass 2: what a leaf adds to the sums of a pixel, for blending by addition. */
std::string blendPassShader();
/** \brief Radius, level and residual of the leaf of the largest weight, by a depth test. */
std::string leafPassShader();
/** \brief What a leaf adds to the colour of the blend that is shown: weighted red, green, blue and
 * the weight, for blending by addition. \param[in] textured whether the surface has textures */
std::string colorPassShader(bool textured);
/** \brief Sums to normal, depth and curvatures, where the leaves cover the blend. */
std::string resultShader();
/** \brief Where rays whose blend is not covered begin again behind it. */
std::string peelShader();

}  // namespace pcl_slim::detail

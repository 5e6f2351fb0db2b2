// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_slim::detail {

// The passes of Ohtake, Belyaev, Alexa 2005, section 3, in GLSL 1.50, each leaf a rectangle around
// its ball and each pixel a ray. The rules are those of the reference rasteriser, in float.

/** \brief Vertices of a leaf's rectangle, the leaf being the instance. */
std::string
leafVertexShader();
/** \brief Vertices of the whole frame. */
std::string
frameVertexShader();

/** \brief Pass 1: depth of a leaf's first root inside its shrunk ball, for blending by minimum. */
std::string
firstPassShader();
/** \brief Pass 2: what a leaf adds to the sums of a pixel, for blending by addition. */
std::string
blendPassShader();
/** \brief Radius, level and residual of the leaf of the largest weight, by a depth test. */
std::string
leafPassShader();
/** \brief What a leaf adds to the colour of the blend that is shown: weighted red, green, blue and the
 * weight, for blending by addition. */
std::string
colorPassShader();
/** \brief Sums to normal, depth and curvatures, where the leaves cover the blend. */
std::string
resultShader();
/** \brief Where rays whose blend is not covered begin again behind it. */
std::string
peelShader();

}  // namespace pcl_slim::detail

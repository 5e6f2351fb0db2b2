// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_slim::detail {

/** \brief GLSL, shared with web/: sRGB to linear light and back. */
extern const char* const kSrgb;

/** \brief GLSL of the pictures' light, shared with web/: lit colours, mirrored stripes, the shade in
 * hollows. It needs kSrgb before it, kLightConstants as constants of their names, the sampler
 * slimGeometry, whose rows begin at the top, and a definition of slimPlace(). */
extern const char* const kLight;

/** \brief kLightConstants as GLSL. */
std::string lightConstantsGlsl();

}  // namespace pcl_slim::detail

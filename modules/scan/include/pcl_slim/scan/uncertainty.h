// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Red, green and blue of a share of a range, from 0 to 1. */
using ShareColor = std::function<std::array<float, 3>(double share)>;

/** \brief Paints a surface with the standard error of its position, in place of its colours:
 * pictures, windows and pages then show it as they show colours.
 *
 * The error is evaluated at some fifty places of each leaf (StandardErrors); paintColors() makes
 * textures of the colours.
 * \param[in] range that the colours span [world units]; equal: 0 to the 95th percentile
 * \param[in] color of a share of the range, as perceptualColor(); channels in [0, 1]
 * \return the range, for a colour bar, or an error, with the surface as it was: of a surface
 * without leaves, or of an error that is nowhere above 0. O(leaves near the places); the same for
 * any number of threads. */
PCL_SLIM_EXPORT Result<std::array<double, 2>> paintUncertainty(SLIMSurface& surface,
                                                               const std::array<double, 2>& range,
                                                               const ShareColor& color,
                                                               int threads = 0);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/shading.h"

/** \brief What a colour bar says beside its numbers, the same in pictures and windows; UTF-8. */
namespace pcl_slim::detail {

/** \brief Whether a text can name a unit of length: up to eight letters, such as mm, µm or ft. */
PCL_SLIM_EXPORT bool isLengthUnit(const std::string& unit);

/** \brief "mean curvature", "radius" ... */
PCL_SLIM_EXPORT std::string barTitle(ShadingMode mode);

/** \brief Such as "1/mm²" of Gaussian curvature; nothing of levels.
 * \param[in] unit of length; none: "length" is in its place */
PCL_SLIM_EXPORT std::string barUnit(ShadingMode mode, const std::string& unit);

/** \brief A number of tickText() with the signs of print: "-2e-5" as "−2·10⁻⁵". */
PCL_SLIM_EXPORT std::string printedTick(const std::string& tick);

}  // namespace pcl_slim::detail

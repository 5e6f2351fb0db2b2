// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief An sRGB colour with channels in [0, 1]. */
using Color = std::array<float, 3>;

/** \brief Blue through light grey to red for x in [-1, 1]; values outside are clamped. */
PCL_SLIM_EXPORT Color divergingColor(double x);

/** \brief Dark blue (0) through green to light yellow (1), evenly lighter; values are clamped. */
PCL_SLIM_EXPORT Color perceptualColor(double x);

/** \brief Red (0, small) through yellow and green to blue (1, large); values are clamped. */
PCL_SLIM_EXPORT Color sizeColor(double x);

/** \brief One of ten well separated colours, repeating. */
PCL_SLIM_EXPORT Color categoryColor(std::uint32_t category);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"

namespace pcl_slim::measure {

/** \brief A scan's row: the mean gradient of L* in a picture of one pixel a point, over that of the
 * points, and the mean CIELAB distance from it, without textures and with them; seconds and bytes.
 * \param[in] pictures where pictures are written, without .png; or nothing */
Error printScan(const std::string& path, const std::string& pictures);

/** \brief Rows of plates with stripes, a checker or a smooth colour: mean CIELAB distance from the
 * truth at places of the plate, of the nearest point, the nearest voxel's centroid, the nearest
 * splat, and the surface without textures and with them. */
Error printPainted();

}  // namespace pcl_slim::measure

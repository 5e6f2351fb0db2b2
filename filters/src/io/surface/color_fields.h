// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Adds the fields of a coloured surface's colours to an empty cloud: rgb, packed as PCL packs it,
 * at the surfels' centres, then the other terms of surfel_color.h, red_u green_u blue_u red_v ... red_uu ...,
 * in 1/255 of white. */
void
addColorFields(pcl::PCLPointCloud2& cloud);

/** \brief Values of the fields of surfel i, 4 bytes each in the order of addColorFields(). */
std::vector<float>
colorValues(const SLIMSurface& surface, std::size_t i);

/** \brief Reads the colours of a cloud of surfels into their surface; terms whose field is missing are 0.
 * A cloud without a field rgb or rgba has none. O(surfels). */
void
takeColors(const pcl::PCLPointCloud2& cloud, SLIMSurface& surface);

}  // namespace pcl_slim

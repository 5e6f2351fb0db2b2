// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief What to subtract from world coordinates for which float is too coarse: fileShift() of the
 * discs' box. Give toPointFile() that of the cloud itself, where there is one: files of its surface
 * have it, too. */
PCL_SLIM_EXPORT std::array<double, 3> splatShift(const SplatSet& splats);

/** \brief Splats as PCL's surfels, in world coordinates less the shift. O(splats). */
PCL_SLIM_EXPORT void toPCL(const SplatSet& splats, const std::array<double, 3>& shift,
                           pcl::PointCloud<pcl::PointSurfel>& cloud);

/** \brief The same as a file: PointSurfel's fields first, then, where there are gradients,
 * red_x red_y red_z green_x ... blue_z (0..255 per unit of length). Comment lines
 * "pcl_slim key value" contain the shift and mark the file as splats. */
PCL_SLIM_EXPORT PointFile toPointFile(const SplatSet& splats, const std::array<double, 3>& shift);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <array>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief Splats as PCL's surfels, in world coordinates less the shift. O(splats). */
PCL_SLIM_EXPORT void toPCL(const SplatSet& splats, const std::array<double, 3>& shift,
                           pcl::PointCloud<pcl::PointSurfel>& cloud);

}  // namespace pcl_slim

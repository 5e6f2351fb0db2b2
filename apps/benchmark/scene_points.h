// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vector>

namespace pcl_slim::comparison {

/** \brief x y z per point as PCL's cloud of floats. */
pcl::PointCloud<pcl::PointXYZ>::Ptr
toCloud(const std::vector<double>& xyz);

/** \brief sqrt(area / points) from the median distance to the 10th neighbour of clean points, as
 * far as they lie evenly on a surface; 0 of ten points or fewer. */
double
spacingOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& clean);

}  // namespace pcl_slim::comparison

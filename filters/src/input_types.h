// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_types.h>

// The point types that the classes are compiled for.
// clang-format off
#define PCL_SLIM_FOR_INPUT_TYPES(WITH) \
  WITH(pcl::PointXYZ) \
  WITH(pcl::PointXYZI) \
  WITH(pcl::PointXYZRGB) \
  WITH(pcl::PointXYZRGBA) \
  WITH(pcl::PointNormal) \
  WITH(pcl::PointXYZINormal) \
  WITH(pcl::PointXYZRGBNormal)

// Those that pcl::MovingLeastSquares is compiled for: PCL_XYZ_POINT_TYPES, in three parts.
#define PCL_SLIM_FOR_PLAIN_TYPES(WITH) \
  WITH(pcl::PointXYZ) \
  WITH(pcl::PointXYZI) \
  WITH(pcl::PointXYZL) \
  WITH(pcl::PointWithRange) \
  WITH(pcl::PointWithViewpoint) \
  WITH(pcl::PointWithScale)
#define PCL_SLIM_FOR_COLOR_TYPES(WITH) \
  WITH(pcl::PointXYZRGB) \
  WITH(pcl::PointXYZRGBA) \
  WITH(pcl::PointXYZRGBL) \
  WITH(pcl::PointXYZLAB) \
  WITH(pcl::PointXYZHSV) \
  WITH(pcl::PointDEM)
#define PCL_SLIM_FOR_NORMAL_TYPES(WITH) \
  WITH(pcl::PointNormal) \
  WITH(pcl::PointXYZINormal) \
  WITH(pcl::PointXYZLNormal) \
  WITH(pcl::PointXYZRGBNormal) \
  WITH(pcl::PointSurfel) \
  WITH(pcl::InterestPoint)
// All of them.
#define PCL_SLIM_FOR_XYZ_TYPES(WITH) \
  PCL_SLIM_FOR_PLAIN_TYPES(WITH) \
  PCL_SLIM_FOR_COLOR_TYPES(WITH) \
  PCL_SLIM_FOR_NORMAL_TYPES(WITH)
// clang-format on

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_types.h>

// The point types of classes that are not compiled for all of
// PCL_XYZ_POINT_TYPES, as SLIMFit and SLIMProjectionSmoother are.
// clang-format off
#define PCL_SLIM_FOR_INPUT_TYPES(WITH) \
  WITH(pcl::PointXYZ) \
  WITH(pcl::PointXYZI) \
  WITH(pcl::PointXYZRGB) \
  WITH(pcl::PointXYZRGBA) \
  WITH(pcl::PointNormal) \
  WITH(pcl::PointXYZINormal) \
  WITH(pcl::PointXYZRGBNormal)
// clang-format on

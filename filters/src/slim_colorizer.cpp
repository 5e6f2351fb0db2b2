// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_colorizer.hpp"

#include "input_types.h"

// clang-format off
#define PCL_SLIM_INSTANTIATE_FOR(In)                                   \
  PCL_SLIM_INSTANTIATE_SLIMColorizer(In, pcl::PointXYZRGB)             \
  PCL_SLIM_INSTANTIATE_SLIMColorizer(In, pcl::PointXYZRGBA)            \
  PCL_SLIM_INSTANTIATE_SLIMColorizer(In, pcl::PointXYZRGBNormal)
// clang-format on

PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_FOR)

// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

#include "input_types.h"

#define PCL_SLIM_TO(Out) PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(PCL_SLIM_FROM, Out)

// SLIMProjectionSmoother from types with normals, and InterestPoint to all of PCL's XYZ types.

#define PCL_SLIM_FROM pcl::PointNormal
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZINormal
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZLNormal
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZRGBNormal
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointSurfel
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::InterestPoint
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM

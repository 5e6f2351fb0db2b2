// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

#include "input_types.h"

#define PCL_SLIM_TO(Out) PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(PCL_SLIM_FROM, Out)

// SLIMProjectionSmoother from types without colours and normals to all of PCL's XYZ types.

#define PCL_SLIM_FROM pcl::PointXYZ
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZI
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZL
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointWithRange
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointWithViewpoint
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointWithScale
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM

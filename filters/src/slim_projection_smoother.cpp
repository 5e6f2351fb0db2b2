// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

#include "input_types.h"

// SLIMProjectionSmoother from all of PCL's XYZ types to all of them. A macro cannot expand itself:
// there is one for each type that points come from.
#define PCL_SLIM_TO(Out) PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(PCL_SLIM_FROM, Out)

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
#define PCL_SLIM_FROM pcl::PointXYZRGB
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZRGBA
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZRGBL
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZLAB
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointXYZHSV
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
#define PCL_SLIM_FROM pcl::PointDEM
PCL_SLIM_FOR_XYZ_TYPES(PCL_SLIM_TO)
#undef PCL_SLIM_FROM
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

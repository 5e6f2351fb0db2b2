// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

#include <pcl/point_types.h>
#include <pcl/impl/instantiate.hpp>

// From all of PCL's XYZ types to all of them.
#define PCL_INSTANTIATE_SLIMProjectionSmoother PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother
PCL_INSTANTIATE_PRODUCT(SLIMProjectionSmoother, (PCL_XYZ_POINT_TYPES)(PCL_XYZ_POINT_TYPES))

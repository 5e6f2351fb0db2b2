// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_fit.hpp"

PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZ) PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZI)
    PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZRGB) PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZRGBA)
        PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointNormal)
            PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZINormal)
                PCL_SLIM_INSTANTIATE_SLIMFit(pcl::PointXYZRGBNormal)

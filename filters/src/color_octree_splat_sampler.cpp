// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/color_octree_splat_sampler.hpp"

PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZ)
    PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZI)
        PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZRGB)
            PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZRGBA)
                PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointNormal)
                    PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZINormal)
                        PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(pcl::PointXYZRGBNormal)

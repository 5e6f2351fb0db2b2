// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/memory.h>
#include <pcl/pcl_macros.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

namespace pcl_slim {

/** \brief Curvature of a surface at a point, as a PCL point; one for each point of a cloud.
 *
 * Curvatures are in 1/length of the cloud's unit, gaussian_curvature in 1/length^2, positive where
 * the surface bends away from the normal: a sphere of radius R has k1 = k2 = 1/R for outward
 * normals. k1 >= k2. Directions are unit, perpendicular to each other and to the normal; their
 * sign means nothing. Curvatures and directions are NaN where no surfel supports the point.
 */
struct EIGEN_ALIGN16 PointCurvature {
  PCL_ADD_NORMAL4D
  float k1 = 0.0f;                  ///< greatest normal curvature
  float k2 = 0.0f;                  ///< least normal curvature
  float mean_curvature = 0.0f;      ///< (k1 + k2) / 2
  float gaussian_curvature = 0.0f;  ///< k1 k2
  float direction1_x = 0.0f, direction1_y = 0.0f, direction1_z = 0.0f;  ///< tangent of k1
  float direction2_x = 0.0f, direction2_y = 0.0f, direction2_z = 0.0f;  ///< tangent of k2

  PointCurvature() : data_n{0.0f, 0.0f, 0.0f, 0.0f} {}

  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim

// clang-format off
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim::PointCurvature,
    (float, normal_x, normal_x)(float, normal_y, normal_y)(float, normal_z, normal_z)
    (float, k1, k1)(float, k2, k2)
    (float, mean_curvature, mean_curvature)(float, gaussian_curvature, gaussian_curvature)
    (float, direction1_x, direction1_x)(float, direction1_y, direction1_y)
    (float, direction1_z, direction1_z)
    (float, direction2_x, direction2_x)(float, direction2_y, direction2_y)
    (float, direction2_z, direction2_z))
// clang-format on

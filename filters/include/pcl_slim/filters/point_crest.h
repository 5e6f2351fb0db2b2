// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/memory.h>
#include <pcl/pcl_macros.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <cstdint>

#include "pcl_slim/core/export.h"
#include "pcl_slim/features/crest_lines.h"

namespace pcl_slim {

/** \brief A vertex of a crest line as a PCL point. Neighbours in a cloud with the same line number
 * are neighbours on the line. Curvatures in 1/length, positive where the surface bends away from
 * the normal. */
struct EIGEN_ALIGN16 PointCrest {
  PCL_ADD_POINT4D
  PCL_ADD_NORMAL4D
  float tangent_x = 0.0f, tangent_y = 0.0f, tangent_z = 0.0f;  ///< unit, along the line
  float k1 = 0.0f, k2 = 0.0f;                                  ///< principal curvatures, k1 >= k2
  float significance = 0.0f;  ///< prominence in deviations of the noise
  float strength = 0.0f;      ///< of the whole line: integral of |k| ds
  std::uint32_t type = 0;     ///< 0: ridge, 1: ravine
  std::uint32_t line = 0;     ///< number of the line, strongest first

  PointCrest() : data{0.0f, 0.0f, 0.0f, 1.0f}, data_n{0.0f, 0.0f, 0.0f, 0.0f} {}

  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

/** \brief Lines as points, line by line in their order; coordinates are rounded to float.
 * O(vertices). */
PCL_SLIM_EXPORT void toPointCloud(const CrestLines& lines, pcl::PointCloud<PointCrest>& cloud);

}  // namespace pcl_slim

// clang-format off
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim::PointCrest,
    (float, x, x)(float, y, y)(float, z, z)
    (float, normal_x, normal_x)(float, normal_y, normal_y)(float, normal_z, normal_z)
    (float, tangent_x, tangent_x)(float, tangent_y, tangent_y)(float, tangent_z, tangent_z)
    (float, k1, k1)(float, k2, k2)(float, significance, significance)(float, strength, strength)
    (std::uint32_t, type, type)(std::uint32_t, line, line))
// clang-format on

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/memory.h>
#include <pcl/pcl_macros.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>

#include <cstdint>
#include <limits>

namespace pcl_slim {

/** \brief Signed distance of a place from a reference, as a PCL point; one for each point of a cloud.
 *
 * x y z is the place that was compared, in the reference's coordinates: where the point meets its
 * cloud's surface, or as measured. Lengths are in the cloud's unit.
 */
struct EIGEN_ALIGN16 PointDeviation {
  PCL_ADD_POINT4D
  /// positive on the side of the reference's normal; NaN without a counterpart
  float deviation = std::numeric_limits<float>::quiet_NaN();
  /// a larger |deviation| is significant at 95 %; NaN without a counterpart
  float level_of_detection = std::numeric_limits<float>::quiet_NaN();
  float sigma_position = 0.0f;    ///< standard error of the place along the surface's normal
  std::int32_t significant = -1;  ///< 1: yes; 0: no; -1: the reference has no counterpart

  PointDeviation() : data{0.0f, 0.0f, 0.0f, 1.0f} {}

  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim

// clang-format off
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim::PointDeviation,
    (float, x, x)(float, y, y)(float, z, z)
    (float, deviation, deviation)(float, level_of_detection, level_of_detection)
    (float, sigma_position, sigma_position)(std::int32_t, significant, significant))
// clang-format on

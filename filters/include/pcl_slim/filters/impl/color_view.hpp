// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/type_traits.h>

#include "pcl_slim/cloud/cloud_view.h"

namespace pcl_slim {

/** The colours of a cloud's points; none for a point type without a field rgb or rgba. */
template <typename PointT>
ColorView colorsOfPoints(const pcl::PointCloud<PointT>& cloud) {
  [[maybe_unused]] const auto* first = reinterpret_cast<const unsigned char*>(cloud.points.data());
  if constexpr (pcl::traits::has_field<PointT, pcl::fields::rgba>::value) {
    return {first + pcl::traits::offset<PointT, pcl::fields::rgba>::value, sizeof(PointT)};
  } else if constexpr (pcl::traits::has_field<PointT, pcl::fields::rgb>::value) {
    return {first + pcl::traits::offset<PointT, pcl::fields::rgb>::value, sizeof(PointT)};
  }
  return {};
}

}  // namespace pcl_slim

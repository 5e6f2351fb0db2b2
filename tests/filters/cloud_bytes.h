// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/point_tests.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstring>
#include <vector>

namespace pcl_slim_test {

/** Coordinates and normals of the finite points, as bytes. */
template <typename PointT>
std::vector<unsigned char> bytesOf(const pcl::PointCloud<PointT>& cloud) {
  std::vector<float> values;
  for (const PointT& p : cloud) {
    if (!pcl::isFinite(p)) continue;
    values.insert(values.end(), {p.x, p.y, p.z});
    if constexpr (pcl::traits::has_normal<PointT>::value) {
      values.insert(values.end(), {p.normal_x, p.normal_y, p.normal_z, p.curvature});
    }
  }
  std::vector<unsigned char> bytes(values.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace pcl_slim_test

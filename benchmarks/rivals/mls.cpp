// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/mls.h"

#include <pcl/point_types.h>
#include <pcl/surface/mls.h>

#include <limits>

namespace pcl_slim::rivals {

Smoothed smoothByMls(const std::vector<Vector3>& points, int order, double radius) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Vector3& p : points) {
    cloud->push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
  mls.setInputCloud(cloud);
  mls.setComputeNormals(true);
  mls.setPolynomialOrder(order);
  mls.setSearchRadius(radius);
  pcl::PointCloud<pcl::PointNormal> output;
  mls.process(output);
  Smoothed smoothed;
  smoothed.points.assign(points.size(), {kNone, kNone, kNone});
  smoothed.normals = smoothed.points;
  const pcl::Indices& source = mls.getCorrespondingIndices()->indices;
  for (std::size_t o = 0; o < output.size(); ++o) {
    const pcl::PointNormal& p = output[o];
    if (!p.getVector3fMap().allFinite() || !p.getNormalVector3fMap().allFinite()) continue;
    const auto i = static_cast<std::size_t>(source[o]);
    smoothed.points[i] = {p.x, p.y, p.z};
    smoothed.normals[i] = {p.normal_x, p.normal_y, p.normal_z};
  }
  return smoothed;
}

}  // namespace pcl_slim::rivals

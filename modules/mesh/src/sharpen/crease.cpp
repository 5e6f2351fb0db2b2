// SPDX-License-Identifier: BSD-3-Clause
#include "sharpen/crease.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

namespace pcl_slim::detail {

bool
meetingOf(const Plane* planes, std::size_t count, const Vector3& near, Vector3& place)
{
  constexpr double kLeastDeterminant = 1e-2;  ///< of unit normals' products: 6 degrees for two
  Eigen::Matrix3d products = Eigen::Matrix3d::Identity();
  Eigen::Vector3d distances = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    distances[row] = dot(planes[i].normal, subtract(planes[i].place, near));
    for (std::size_t j = 0; j < count; ++j) {
      products(row, static_cast<Eigen::Index>(j)) = dot(planes[i].normal, planes[j].normal);
    }
  }
  if (!(std::abs(products.determinant()) > kLeastDeterminant)) return false;
  const Eigen::Vector3d steps = products.inverse() * distances;
  place = near;
  for (std::size_t i = 0; i < count; ++i) {
    place = along(place, steps[static_cast<Eigen::Index>(i)], planes[i].normal);
  }
  return true;
}

}  // namespace pcl_slim::detail

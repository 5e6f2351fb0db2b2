// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>

#include <cmath>
#include <memory>
#include <random>

namespace pcl_slim_test {

constexpr double kMajor = 1.0, kMinor = 0.4;  ///< radii of the torus

/** A point with its coordinates, and the normal where the type has one. */
template <typename PointT>
PointT exactPoint(const double (&p)[3], const double (&n)[3]) {
  PointT point;
  point.x = static_cast<float>(p[0]);
  point.y = static_cast<float>(p[1]);
  point.z = static_cast<float>(p[2]);
  if constexpr (pcl::traits::has_normal<PointT>::value) {
    point.normal_x = static_cast<float>(n[0]);
    point.normal_y = static_cast<float>(n[1]);
    point.normal_z = static_cast<float>(n[2]);
  }
  return point;
}

/** A sphere about 0, points evenly spread, moved along their normals by Gaussian noise. */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr sphereCloud(std::size_t count, double radius, double sigma,
                                                  unsigned seed = 11) {
  auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < count; ++i) {
    double n[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(n[0], n[1], n[2]), r = radius + sigma * normal(random);
    for (double& value : n) value /= length;
    cloud->push_back(exactPoint<PointT>({r * n[0], r * n[1], r * n[2]}, n));
  }
  return cloud;
}

/** A sphere about 0 with Gaussian noise along x, y and z, without what is above z = top * radius.
 */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr noisySphere(std::size_t count, double radius, double sigma,
                                                  double top = 2.0) {
  auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  while (cloud->size() < count) {
    const double n[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(n[0], n[1], n[2]);
    if (n[2] / length > top) continue;
    PointT p;
    for (int a = 0; a < 3; ++a)
      p.data[a] = static_cast<float>(radius * n[a] / length + sigma * normal(random));
    cloud->push_back(p);
  }
  return cloud;
}

/** A torus about the z axis; even in both angles, which is near enough. */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr torusCloud(std::size_t count, double sigma) {
  auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(0.0, 2.0 * M_PI);
  for (std::size_t i = 0; i < count; ++i) {
    const double a = angle(random), b = angle(random), r = kMinor + sigma * normal(random);
    const double n[3] = {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    cloud->push_back(exactPoint<PointT>(
        {kMajor * std::cos(a) + r * n[0], kMajor * std::sin(a) + r * n[1], r * n[2]}, n));
  }
  return cloud;
}

template <typename PointT>
double sphereDistance(const PointT& p, double radius) {
  return std::hypot(static_cast<double>(p.x), p.y, p.z) - radius;
}

template <typename PointT>
double torusDistance(const PointT& p) {
  return std::hypot(std::hypot(static_cast<double>(p.x), p.y) - kMajor, static_cast<double>(p.z)) -
         kMinor;
}

}  // namespace pcl_slim_test

// SPDX-License-Identifier: BSD-3-Clause
#include "compare/m3c2.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "rivals/point_tree.h"
#include "support/lab/bench.h"

namespace pcl_slim::change {

namespace {

constexpr std::size_t kLeastPoints = 4;

/** The direction in which points about a place vary least. */
Vector3 normalOf(const std::vector<Vector3>& points, const std::vector<std::size_t>& near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : near) mean += Eigen::Map<const Eigen::Vector3d>(points[i].data());
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::size_t i : near) {
    const Eigen::Vector3d off = Eigen::Map<const Eigen::Vector3d>(points[i].data()) - mean;
    covariance += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  return {axis[0], axis[1], axis[2]};
}

/** Mean and variance of the points in a cylinder, along its axis. */
struct Spread {
  std::size_t count = 0;
  double mean = 0, variance = 0;
};

Spread spreadOf(const rivals::PointTree& tree, const std::vector<Vector3>& points,
                const Vector3& at, const Vector3& axis, const M3C2Scales& scales) {
  Spread spread;
  double sum = 0, squares = 0;
  for (const std::size_t i : tree.within(at, std::hypot(scales.projection, scales.depth))) {
    const Vector3 off = subtract(points[i], at);
    const double height = dot(off, axis);
    const double aside_sq = dot(off, off) - height * height;
    if (std::abs(height) > scales.depth || aside_sq > scales.projection * scales.projection)
      continue;
    ++spread.count;
    sum += height;
    squares += height * height;
  }
  if (spread.count < kLeastPoints) return spread;
  const auto n = static_cast<double>(spread.count);
  spread.mean = sum / n;
  spread.variance = std::max(0.0, (squares - n * spread.mean * spread.mean) / (n - 1));
  return spread;
}

}  // namespace

Estimate m3c2(const Scan& scan, const Scan& reference, const std::vector<std::size_t>& cores,
              const M3C2Scales& scales) {
  Estimate made;
  const double start = measure::cpuSeconds();
  const rivals::PointTree own(scan.points), other(reference.points);
  const double trees = measure::cpuSeconds() - start;
  for (const std::size_t i : cores) {
    double distance = std::numeric_limits<double>::quiet_NaN(), detection = distance;
    const auto near = own.within(scan.points[i], scales.normal);
    if (near.size() >= kLeastPoints) {
      Vector3 axis = normalOf(scan.points, near);
      if (dot(axis, scan.normals[i]) < 0) axis = scaled(axis, -1);
      const Spread a = spreadOf(own, scan.points, scan.points[i], axis, scales);
      const Spread b = spreadOf(other, reference.points, scan.points[i], axis, scales);
      if (a.count >= kLeastPoints && b.count >= kLeastPoints) {
        distance = a.mean - b.mean;
        detection = 1.96 * std::sqrt(a.variance / static_cast<double>(a.count) +
                                     b.variance / static_cast<double>(b.count));
      }
    }
    made.distance.push_back(distance);
    made.detection.push_back(detection);
  }
  // Of all points, not only those chosen.
  made.seconds = trees + (measure::cpuSeconds() - start - trees) *
                             static_cast<double>(scan.points.size()) /
                             static_cast<double>(cores.size());
  return made;
}

}  // namespace pcl_slim::change

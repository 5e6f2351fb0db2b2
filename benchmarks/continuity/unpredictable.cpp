// SPDX-License-Identifier: BSD-3-Clause
#include "continuity/unpredictable.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"
#include "rivals/point_tree.h"

namespace pcl_slim::continuity {

namespace {

constexpr std::size_t kTried = 2000;
constexpr int kNeighbors[] = {8, 12, 16, 24, 36, 54, 80};
constexpr int kDegrees = 3;

/** Distance of the origin from the surface z(x, y) of a degree that fits these points best. */
double offSurface(const Eigen::MatrixX3d& near, int degree) {
  const Eigen::RowVector3d middle = near.colwise().mean();
  const Eigen::MatrixX3d about = near.rowwise() - middle;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(about.transpose() * about);
  // x and y along the plane, z across.
  const Eigen::MatrixX3d turned = near * axes.eigenvectors().rowwise().reverse();
  const double radius = turned.rowwise().norm().maxCoeff();
  const Eigen::MatrixX3d local = turned / radius;
  const auto coefficients = static_cast<Eigen::Index>((degree + 1) * (degree + 2) / 2);
  Eigen::MatrixXd terms(near.rows(), coefficients);
  const Eigen::ArrayXd x = local.col(0), y = local.col(1);
  Eigen::Index column = 0;
  for (int d = 0; d <= degree; ++d) {
    for (int k = 0; k <= d; ++k) terms.col(column++) = x.pow(d - k) * y.pow(k);
  }
  const Eigen::ArrayXd from_sq = x.square() + y.square();
  const Eigen::ArrayXd weight = (-2 * from_sq / from_sq.maxCoeff()).exp();
  const Eigen::VectorXd c = (terms.array().colwise() * weight)
                                .matrix()
                                .colPivHouseholderQr()
                                .solve((local.col(2).array() * weight).matrix());
  return radius * std::abs(c[0]) / std::sqrt(1 + c[1] * c[1] + c[2] * c[2]);
}

std::vector<Vector3> distinctOf(const Points& points) {
  std::vector<Vector3> distinct;
  for (const Eigen::Vector3d& p : points) distinct.push_back({p.x(), p.y(), p.z()});
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

/** The nearest points to a point but itself, relative to it, nearest first. */
Eigen::MatrixX3d pointsAbout(const std::vector<Vector3>& points, const rivals::PointTree& tree,
                             std::size_t i) {
  const auto nearest = tree.nearest(points[i], *std::rbegin(kNeighbors) + 1);
  Eigen::MatrixX3d about(static_cast<Eigen::Index>(nearest.size() - 1), 3);
  for (Eigen::Index k = 0; k < about.rows(); ++k) {
    const Vector3 from = subtract(points[nearest[static_cast<std::size_t>(k) + 1]], points[i]);
    about.row(k) << from[0], from[1], from[2];
  }
  return about;
}

}  // namespace

double unpredictable(const Points& points, std::uint64_t seed) {
  const std::vector<Vector3> distinct = distinctOf(points);
  const rivals::PointTree tree(distinct);
  std::vector<std::size_t> all(distinct.size()), tried;
  std::iota(all.begin(), all.end(), 0);
  std::mt19937_64 rng(seed);
  std::sample(all.begin(), all.end(), std::back_inserter(tried), kTried, rng);
  std::vector<Eigen::MatrixX3d> about;
  about.reserve(tried.size());
  for (const std::size_t i : tried) about.push_back(pointsAbout(distinct, tree, i));
  double best = std::numeric_limits<double>::infinity();
  for (const int k : kNeighbors) {
    for (int degree = 1; degree <= kDegrees; ++degree) {
      if (k < 3 * (degree + 1) * (degree + 2) / 4) continue;  // 1.5 points a coefficient
      std::vector<double> off;
      for (const Eigen::MatrixX3d& near : about) {
        if (near.rows() >= k) off.push_back(offSurface(near.topRows(k), degree));
      }
      if (!off.empty()) best = std::min(best, median(std::move(off)));
    }
  }
  return best;
}

}  // namespace pcl_slim::continuity

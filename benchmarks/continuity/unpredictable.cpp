// SPDX-License-Identifier: BSD-3-Clause
#include "continuity/unpredictable.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "rivals/point_tree.h"

namespace pcl_slim::continuity {

namespace {

constexpr std::size_t kTried = 2000;
constexpr int kNeighbors[] = {8, 12, 16, 24, 36, 54, 80};
constexpr int kDegrees = 3;

/** Distance of the origin from the surface z(x, y) of a degree that fits these points best. */
double
offSurface(const Eigen::MatrixX3d& near, int degree)
{
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

}  // namespace

double
unpredictable(const Points& points, std::uint64_t seed)
{
  std::vector<Vector3> distinct;
  for (const Eigen::Vector3d& p : points) distinct.push_back({p.x(), p.y(), p.z()});
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const rivals::PointTree tree(distinct);
  std::vector<std::size_t> all(distinct.size()), tried;
  std::iota(all.begin(), all.end(), 0);
  std::mt19937_64 rng(seed);
  std::sample(all.begin(), all.end(), std::back_inserter(tried), kTried, rng);
  std::vector<std::vector<double>> off(std::size(kNeighbors) * kDegrees);
  for (const std::size_t i : tried) {
    const auto nearest = tree.nearest(distinct[i], *std::rbegin(kNeighbors) + 1);
    Eigen::MatrixX3d near(static_cast<Eigen::Index>(nearest.size() - 1), 3);
    for (Eigen::Index k = 0; k < near.rows(); ++k) {
      for (int a = 0; a < 3; ++a)
        near(k, a) = distinct[nearest[static_cast<std::size_t>(k) + 1]][a] - distinct[i][a];
    }
    for (std::size_t n = 0; n < std::size(kNeighbors); ++n) {
      for (int degree = 1; degree <= kDegrees; ++degree) {
        const int least = 3 * (degree + 1) * (degree + 2) / 4;  // 1.5 points a coefficient
        if (kNeighbors[n] < least || near.rows() < kNeighbors[n]) continue;
        off[n * kDegrees + static_cast<std::size_t>(degree - 1)].push_back(
            offSurface(near.topRows(kNeighbors[n]), degree));
      }
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (std::vector<double>& one : off) {
    if (one.empty()) continue;
    const auto middle = one.begin() + static_cast<std::ptrdiff_t>(one.size() / 2);
    std::nth_element(one.begin(), middle, one.end());
    best = std::min(best, *middle);
  }
  return best;
}

}  // namespace pcl_slim::continuity

// SPDX-License-Identifier: BSD-3-Clause
#include "disc/disc_shape.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAgree = 0.1;              ///< variance of normals up to which they have one axis
constexpr std::size_t kPlanePoints = 16;    ///< on either side, for a cell without normals
constexpr std::size_t kGradientPoints = 6;  ///< fewer do not tell a slope from noise

Matrix3d
matrixOf(const Symmetric3<double>& m)
{
  Matrix3d s;
  s << m[kXX], m[kXY], m[kXZ], m[kXY], m[kYY], m[kYZ], m[kXZ], m[kYZ], m[kZZ];
  return s;
}

Vector3d
vectorOf(const std::array<float, 3>& v)
{
  return {v[0], v[1], v[2]};
}

/** Largest eigenvector of sum n n^T, on the side of the normals' sum. */
Vector3d
widestAxis(const CellSums& sums)
{
  const Vector3d sum(sums.normal[0], sums.normal[1], sums.normal[2]);
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrixOf(sums.product));
  const Vector3d n = solver.eigenvectors().col(2);
  return n.dot(sum) < 0.0 ? Vector3d(-n) : n;
}

/** Normal of the plane through the points around a cell, as far as the window holds them. */
Vector3d
planeNormal(const PointWindow& window, const OctreeCell& cell)
{
  std::size_t begin = cell.begin, end = cell.end;
  if (end - begin < 3) {
    begin = std::max(window.begin() + kPlanePoints, begin) - kPlanePoints;
    end = std::min(window.end(), end + kPlanePoints);
  }
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = begin; i < end; ++i) mean += vectorOf(window.position(i));
  mean /= static_cast<double>(end - begin);
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    const Vector3d d = vectorOf(window.position(i)) - mean;
    covariance += d * d.transpose();
  }
  if (!(covariance.cwiseAbs().maxCoeff() > 0.0)) return Vector3d::UnitZ();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().col(0);
}

/** Of a cell without one axis. */
DiscNormal
unevenNormal(const PointWindow& window, const OctreeCell& cell, const CellSums& sums)
{
  const double total = sums.normals();
  const bool any = total > 0.5;
  const Vector3d n = any ? widestAxis(sums) : planeNormal(window, cell);
  const double share = any ? n.dot(matrixOf(sums.product) * n) / total : 1.0;
  return {{n[0], n[1], n[2]}, std::clamp(1.0 - share, 0.0, 2.0 / 3.0)};
}

/** How Lab changes over a disc's plane. */
struct ColorSlope {
  Eigen::Matrix<double, 3, 2> frame;  ///< axes of the plane
  Eigen::Matrix<double, 2, 3> slope;  ///< Lab along each of them
  double rim;                         ///< standard deviation of the points' places
};

/** Least squares, less the share that noise alone explains. \return false where points on a line,
 * or in one place, tell no slope. */
bool
fitColorSlope(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
              const Vector3d& normal, double noise, ColorSlope& color)
{
  const Vector3d center =
      Vector3d(sums.position[0], sums.position[1], sums.position[2]) / sums.count;
  const Vector3d mean = Vector3d(sums.lab[0], sums.lab[1], sums.lab[2]) / sums.count;
  color.frame.col(0) = normal.unitOrthogonal();
  color.frame.col(1) = normal.cross(color.frame.col(0));
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Matrix<double, 2, 3> mixed = Eigen::Matrix<double, 2, 3>::Zero();
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const Eigen::Vector2d at = color.frame.transpose() * (vectorOf(window.position(i)) - center);
    spread += at * at.transpose();
    mixed += at * (vectorOf(window.lab(i)) - mean).transpose();
  }
  const double trace = spread.trace();
  if (!(trace > 0.0) || spread.determinant() < 1e-3 * trace * trace) return false;
  color.slope = spread.inverse() * mixed;
  const double explained = color.slope.cwiseProduct(mixed).sum();
  const double total = sums.colorVariance() * sums.count;
  const double rest = std::max(std::max(0.0, total - explained) / (sums.count - 3.0), noise);
  color.slope *= std::max(0.0, 1.0 - 2.0 * rest / std::max(explained, 1e-12));
  color.rim = std::sqrt(trace / sums.count);
  return true;
}

}  // namespace

std::vector<DiscNormal>
discNormals(const PointWindow& window, const CellBatch& batch)
{
  std::vector<double> rows(4 * batch.size());
  std::vector<DiscNormal> normals(batch.size());
  splat_kernels::commonNormals(&batch.sums.data()->count, batch.size(), kAgree, rows.data());
  for (std::size_t c = 0; c < batch.size(); ++c) {
    const double* row = rows.data() + 4 * c;
    normals[c] = row[3] < 0.0 ? unevenNormal(window, batch.cells[c], batch.sums[c])
                              : DiscNormal{{row[0], row[1], row[2]}, row[3]};
  }
  return normals;
}

DiscReach
discReach(const PointWindow& window, const OctreeCell& cell, const std::array<float, 3>& center)
{
  std::size_t nearest = 0;
  const float farthest = splat_kernels::farthestAndNearest(
      window.column(PointWindow::kX, cell.begin), window.column(PointWindow::kY, cell.begin),
      window.column(PointWindow::kZ, cell.begin), cell.end - cell.begin, center.data(), nearest);
  return {cell.begin + nearest, std::sqrt(farthest)};
}

SplatSet::Gradient
discGradient(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
             const std::array<double, 3>& normal, const LabTable& table, double noise, double edge)
{
  SplatSet::Gradient gradient{};
  if (cell.end - cell.begin < kGradientPoints) return gradient;
  ColorSlope color;
  if (!fitColorSlope(window, cell, sums, {normal[0], normal[1], normal[2]}, noise, color)) {
    return gradient;
  }
  const Vector3d mean = Vector3d(sums.lab[0], sums.lab[1], sums.lab[2]) / sums.count;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Vector3d step = color.slope.row(k).transpose() * color.rim;
    const Vector3d low = mean - step, high = mean + step;
    const float from[3] = {float(low[0]), float(low[1]), float(low[2])};
    const float to[3] = {float(high[0]), float(high[1]), float(high[2])};
    const auto a = table.rgbUnrounded(from), b = table.rgbUnrounded(to);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double change = (b[channel] - a[channel]) / (2.0 * color.rim * edge);
      for (Eigen::Index d = 0; d < 3; ++d) {
        gradient[3 * channel + static_cast<std::size_t>(d)] +=
            static_cast<float>(change * color.frame(d, k));
      }
    }
  }
  return gradient;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "splat_builder.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "octree_roots.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kGradientPoints = 6;  ///< fewer do not tell a slope from noise

Matrix3d
symmetric(const double m[6])
{
  Matrix3d s;
  s << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  return s;
}

/** Axis along which normals agree, on the side of their sum. */
Vector3d
commonNormal(const CellSums& sums)
{
  const Matrix3d product = symmetric(sums.product);
  const Vector3d sum(sums.normal[0], sums.normal[1], sums.normal[2]);
  Vector3d n = sum;
  // In a cell whose normals differ little the power method gains digits at every step.
  if (sum.squaredNorm() > 0.25 * sums.count * sums.count) {
    n.normalize();
    for (int step = 0; step < 12; ++step) {
      const Vector3d next = (product * n).normalized();
      const bool still = (next - n).squaredNorm() < 1e-16;
      n = next;
      if (still) return n;
    }
  }
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver(product);
  n = solver.eigenvectors().col(2);
  return n.dot(sum) < 0.0 ? Vector3d(-n) : n;
}

/** Normal of the plane through points without normals; where they are too few, of the smallest
 * cell around them with enough. */
Vector3d
planeNormal(const OctreeCloud& cloud, OctreeCell cell)
{
  for (int level = cell.shift; cell.end - cell.begin < 3 && level < OctreeCloud::kBits; ++level) {
    const int bits = kBitsPerLevel * (level + 1);
    const std::uint64_t key = cloud.keys()[cell.begin] >> bits;
    while (cell.begin > 0 && cloud.keys()[cell.begin - 1] >> bits == key) --cell.begin;
    while (cell.end < cloud.size() && cloud.keys()[cell.end] >> bits == key) ++cell.end;
  }
  Vector3d mean = Vector3d::Zero();
  const auto at = [&](std::size_t i) {
    const float* p = cloud.point(i).position;
    return Vector3d(p[0], p[1], p[2]);
  };
  for (std::size_t i = cell.begin; i < cell.end; ++i) mean += at(i);
  mean /= static_cast<double>(cell.end - cell.begin);
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    covariance += (at(i) - mean) * (at(i) - mean).transpose();
  }
  if (!(covariance.cwiseAbs().maxCoeff() > 0.0)) return Vector3d::UnitZ();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().col(0);
}

/** Builds the splats of one cloud. */
class Builder {
 public:
  Builder(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells,
          const SplatSources& sources, const SplatParams& params, SplatSet& splats)
      : cloud_(cloud),
        cells_(cells),
        sources_(sources),
        params_(params),
        splats_(splats),
        widest_(widestSpacing(cells)),
        discs_(cells.size()),
        radii_(cells.size(), 0.0f)
  {
    splats.origin = cloud.origin();
    splats.resize(cells.size(), params.color == SplatColor::kGradient);
  }

  void run()
  {
    parallelFor(cells_.size(), params_.threads, 256, [&](std::size_t c, int) { place(c); });
    if (params_.radius == RadiusRule::kNeighbors && sources_.store) {
      radii_ = neighborRadii(cloud_, cells_, discs_, *sources_.store, params_.threads);
    }
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      splats_.radius[c] = static_cast<float>(radii_[c] * cloud_.cell());
    }
  }

 private:
  void place(std::size_t c)
  {
    const OctreeCell& cell = cells_[c];
    const CellSums sums = sumsOf(cloud_, cell.begin, cell.end);
    Disc& disc = discs_[c];
    std::array<double, 3> cube{};
    if (params_.paper_mode || params_.radius == RadiusRule::kCorner) {
      cube = cloud_.center(cell.begin, cell.shift);
    }
    for (std::size_t a = 0; a < 3; ++a) disc.center[a] = sums.position[a] / sums.count;
    const OctreePoint& kept = nearestPoint(cell, params_.paper_mode ? cube : disc.center);
    if (params_.paper_mode) disc.center = {kept.position[0], kept.position[1], kept.position[2]};
    const Vector3d normal = normalOf(cell, sums, kept);
    disc.normal = {normal[0], normal[1], normal[2]};
    if (params_.radius == RadiusRule::kCorner) {
      radii_[c] = static_cast<float>(cornerRadius(disc.center, cube, cloud_.edge(cell.shift)));
    } else if (params_.radius == RadiusRule::kDensity) {
      const double reach = reachOfPoints(cloud_, cell, disc);
      radii_[c] = static_cast<float>(densityRadius(cell, reach, widest_));
    }
    write(c, sums, kept);
  }

  const OctreePoint& nearestPoint(const OctreeCell& cell, const std::array<double, 3>& target) const
  {
    const OctreePoint* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const OctreePoint& q = cloud_.point(i);
      double sq = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        sq += (q.position[a] - target[a]) * (q.position[a] - target[a]);
      }
      if (sq < least) {
        least = sq;
        best = &q;
      }
    }
    return *best;
  }

  Vector3d normalOf(const OctreeCell& cell, const CellSums& sums, const OctreePoint& kept) const
  {
    const Vector3d own(kept.normal[0], kept.normal[1], kept.normal[2]);
    if (params_.paper_mode && own.squaredNorm() > 0.5) return own.normalized();
    return sums.normals() > 0.5 ? commonNormal(sums) : planeNormal(cloud_, cell);
  }

  void write(std::size_t c, const CellSums& sums, const OctreePoint& kept)
  {
    const Disc& disc = discs_[c];
    float* const centers[3] = {&splats_.x[c], &splats_.y[c], &splats_.z[c]};
    float* const normals[3] = {&splats_.nx[c], &splats_.ny[c], &splats_.nz[c]};
    for (std::size_t a = 0; a < 3; ++a) {
      *centers[a] = static_cast<float>(disc.center[a] * cloud_.cell());
      *normals[a] = static_cast<float>(disc.normal[a]);
    }
    const std::size_t input = sources_.cloud.inputIndex(kept.order);
    splats_.kept[c] = static_cast<std::uint32_t>(input);
    splats_.confidence[c] = static_cast<float>(sums.count);
    splats_.curvature[c] = static_cast<float>(sums.unorientedVariance());
    splats_.rgb[c] = colorOf(sums, input);
    if (!splats_.gradient.empty()) splats_.gradient[c] = gradientOf(c, sums);
  }

  std::uint32_t colorOf(const CellSums& sums, std::size_t input) const
  {
    if (!cloud_.hasColors()) return 0xffffffu;
    if (params_.color == SplatColor::kOwn || sums.count < 2) {
      const unsigned char* bgr =
          static_cast<const unsigned char*>(sources_.colors.bgr) + input * sources_.colors.stride;
      return static_cast<std::uint32_t>(bgr[2] << 16 | bgr[1] << 8 | bgr[0]);
    }
    float lab[3];
    for (int a = 0; a < 3; ++a) lab[a] = static_cast<float>(sums.lab[a] / sums.count);
    const auto rgb = sources_.table.rgb(lab);
    return static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
  }

  /** Least squares of Lab over the disc's plane, less the share that noise alone explains, as
   * differences of display colours from one rim of the points to the other. */
  SplatSet::Gradient gradientOf(std::size_t c, const CellSums& sums) const
  {
    SplatSet::Gradient gradient{};
    const OctreeCell& cell = cells_[c];
    const std::size_t n = cell.end - cell.begin;
    if (!cloud_.hasColors() || n < kGradientPoints) return gradient;
    const Vector3d normal(discs_[c].normal[0], discs_[c].normal[1], discs_[c].normal[2]);
    const Vector3d center(discs_[c].center[0], discs_[c].center[1], discs_[c].center[2]);
    const Vector3d mean(sums.lab[0] / sums.count, sums.lab[1] / sums.count,
                        sums.lab[2] / sums.count);
    Eigen::Matrix<double, 3, 2> frame;
    frame.col(0) = normal.unitOrthogonal();
    frame.col(1) = normal.cross(frame.col(0));
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    Eigen::Matrix<double, 2, 3> mixed = Eigen::Matrix<double, 2, 3>::Zero();
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const OctreePoint& q = cloud_.point(i);
      const Eigen::Vector2d at =
          frame.transpose() * (Vector3d(q.position[0], q.position[1], q.position[2]) - center);
      spread += at * at.transpose();
      mixed += at * (Vector3d(q.lab[0], q.lab[1], q.lab[2]) - mean).transpose();
    }
    const double trace = spread.trace();
    if (!(trace > 0.0) || spread.determinant() < 1e-3 * trace * trace) return gradient;
    Eigen::Matrix<double, 2, 3> slope = spread.inverse() * mixed;
    const double explained = slope.cwiseProduct(mixed).sum();
    const double total = sums.colorVariance() * sums.count;
    const double noise =
        std::max(std::max(0.0, total - explained) / (sums.count - 3.0), sources_.noise.color);
    slope *= std::max(0.0, 1.0 - 2.0 * noise / std::max(explained, 1e-12));
    const double rim = std::sqrt(trace / sums.count);
    for (Eigen::Index k = 0; k < 2; ++k) {
      const Vector3d step = slope.row(k).transpose() * rim;
      const Vector3d low = mean - step, high = mean + step;
      const float from[3] = {float(low[0]), float(low[1]), float(low[2])};
      const float to[3] = {float(high[0]), float(high[1]), float(high[2])};
      const auto a = sources_.table.rgbUnrounded(from), b = sources_.table.rgbUnrounded(to);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double change = (b[channel] - a[channel]) / (2.0 * rim * cloud_.cell());
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          gradient[3 * channel + static_cast<std::size_t>(axis)] +=
              static_cast<float>(change * frame(axis, k));
        }
      }
    }
    return gradient;
  }

  const OctreeCloud& cloud_;
  const std::vector<OctreeCell>& cells_;
  const SplatSources& sources_;
  const SplatParams& params_;
  SplatSet& splats_;
  double widest_;
  std::vector<Disc> discs_;
  std::vector<float> radii_;
};

}  // namespace

void
buildSplats(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells,
            const SplatSources& sources, const SplatParams& params, SplatSet& splats,
            SplatStatistics& statistics)
{
  Builder(cloud, cells, sources, params, splats).run();
  statistics.splats = cells.size();
  for (const OctreeCell& cell : cells) {
    statistics.single_points += cell.end - cell.begin == 1;
    bool has_normal = false;
    for (std::size_t i = cell.begin; i < cell.end && !has_normal; ++i) {
      const float* n = cloud.point(i).normal;
      has_normal = n[0] != 0 || n[1] != 0 || n[2] != 0;
    }
    statistics.without_normal += !has_normal;
  }
  statistics.spacing = widestSpacing(cells) / 6.0 * cloud.cell();
}

}  // namespace pcl_slim

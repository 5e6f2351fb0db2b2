// SPDX-License-Identifier: BSD-3-Clause
// Step 3 of docs/color_octree_splat_sampler.md: each leaf becomes a disc.
#include "disc/splat_builder.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/splat_radius.h"

namespace pcl_slim::detail {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAgree = 0.1;              ///< variance of normals up to which they have one axis
constexpr std::size_t kPlanePoints = 16;    ///< on either side, for a cell without normals
constexpr std::size_t kGradientPoints = 6;  ///< with fewer a slope cannot be separated from noise

Matrix3d matrixOf(const Symmetric3<double>& m) {
  Matrix3d s;
  s << m[kXX], m[kXY], m[kXZ], m[kXY], m[kYY], m[kYZ], m[kXZ], m[kYZ], m[kZZ];
  return s;
}

Vector3d vectorOf(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

/** Largest eigenvector of sum n n^T, on the side of the normals' sum. */
Vector3d widestAxis(const CellSums& sums) {
  const Vector3d sum(sums.normal[0], sums.normal[1], sums.normal[2]);
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrixOf(sums.product));
  const Vector3d n = solver.eigenvectors().col(2);
  return n.dot(sum) < 0.0 ? Vector3d(-n) : n;
}

/** Normal of the plane through the points around a cell, as far as the window contains them. */
Vector3d planeNormal(const PointWindow& window, const OctreeCell& cell) {
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
DiscNormal unevenNormal(const PointWindow& window, const OctreeCell& cell, const CellSums& sums) {
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
 * or in one place, determine no slope. */
bool fitColorSlope(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
                   const Vector3d& normal, double noise, ColorSlope& color) {
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

constexpr std::size_t kSpacingCells = 1024;  ///< cells for the middle spacing
constexpr double kNoiseSlack = 2.0;  ///< times the variance of noisy normals that is not bend
constexpr double kFollowed = 2.0;    ///< reach of gradients over that of their points

/** Spacing around a cell with too few points for its own: that of the smallest cell of roots around
 * it with enough points, of those in the window that kSpacingReach allows. */
double spacingAround(const OctreeCloud& cloud, const PointWindow& window, const OctreeCell& cell) {
  const std::size_t r = cloud.rootOf(cell.begin);
  const std::size_t low =
      std::max<std::size_t>(window.begin() + kSpacingReach, cell.begin) - kSpacingReach;
  const std::size_t high = std::min<std::size_t>(window.end(), cell.end + kSpacingReach);
  std::size_t first = r, last = r + 1;
  std::size_t begin = std::max<std::size_t>(low, cloud.root(first).begin);
  std::size_t end = std::min<std::size_t>(high, cloud.root(last).begin);
  for (int growth = 1; end - begin < kSpacingPoints && growth <= OctreeCloud::kBits; ++growth) {
    const std::uint64_t key = cloud.root(r).key >> 3 * growth;
    while (begin > low && cloud.root(first - 1).key >> 3 * growth == key) {
      begin = std::max<std::size_t>(low, cloud.root(--first).begin);
    }
    while (end < high && cloud.root(last).key >> 3 * growth == key) {
      end = std::min<std::size_t>(high, cloud.root(++last).begin);
    }
  }
  return sumsOf(window, begin, end).spacing();
}

/** Axes along which cells' normals agree, on the side of their sum; those of the planes through the
 * points around where none has one. */
std::vector<DiscNormal> discNormals(const PointWindow& window, const CellBatch& batch) {
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

/** Of a cell's points, the one nearest to a place and the distance of the farthest from it, in root
 * cells. */
struct DiscReach {
  std::size_t nearest;
  float farthest;
};

DiscReach discReach(const PointWindow& window, const OctreeCell& cell,
                    const std::array<float, 3>& center) {
  std::size_t nearest = 0;
  const float farthest = splat_kernels::farthestAndNearest(
      window.column(PointWindow::kX, cell.begin), window.column(PointWindow::kY, cell.begin),
      window.column(PointWindow::kZ, cell.begin), cell.end - cell.begin, center.data(), nearest);
  return {cell.begin + nearest, std::sqrt(farthest)};
}

/** How colour changes across a disc: least squares of Lab over its plane, less the share that noise
 * alone explains, as differences of display colours from one rim of the points to the other.
 * edge: world units of a root cell. */
SplatSet::Gradient discGradient(const PointWindow& window, const OctreeCell& cell,
                                const CellSums& sums, const std::array<double, 3>& normal,
                                const LabTable& table, double noise, double edge) {
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

}  // namespace

SplatBuilder::SplatBuilder(const OctreeCloud& cloud, const OctreeSource& source,
                           const SplatParams& params, const SampleNoise& noise, std::size_t slices)
    : cloud_(cloud),
      source_(source),
      params_(params),
      color_noise_(noise.color),
      normal_noise_(noise.normal),
      slices_(slices) {
  if (params.radius == RadiusRule::kNeighbors) disc_of_.resize(source.cloud.count());
}

void SplatBuilder::add(std::size_t slice, const PointWindow& window, const CellBatch& batch) {
  Slice out;  // not in its place yet: other threads write to its neighbours
  out.rows.reserve(batch.size());
  const std::vector<DiscNormal> normals = discNormals(window, batch);
  for (std::size_t c = 0; c < batch.size(); ++c) {
    const OctreeCell& cell = batch.cells[c];
    const CellSums& sums = batch.sums[c];
    DiscNormal normal = normals[c];
    Row row = rowOf(window, cell, sums, normal);
    note(slice, window, cell, out);
    out.rows.push_back(row);
    out.single_points += cell.end - cell.begin == 1;
    out.without_normal += !(sums.normals() > 0.0);
    if (params_.color == SplatColor::kGradient) {
      out.gradients.push_back(gradientOf(window, cell, sums, normal));
    }
  }
  slices_[slice] = std::move(out);
}

/** Remembers which disc each point of a cell belongs to, where radii are found by that. */
void SplatBuilder::note(std::size_t slice, const PointWindow& window, const OctreeCell& cell,
                        const Slice& out) {
  for (std::size_t i = cell.begin; i < cell.end && !disc_of_.empty(); ++i) {
    disc_of_[window.order(i)] = {static_cast<std::uint32_t>(slice),
                                 static_cast<std::uint32_t>(out.rows.size())};
  }
}

/** A cell's disc. normal becomes the kept point's own in paper mode. */
SplatBuilder::Row SplatBuilder::rowOf(const PointWindow& window, const OctreeCell& cell,
                                      const CellSums& sums, DiscNormal& normal) const {
  Row row;
  for (std::size_t a = 0; a < 3; ++a) {
    row.center[a] = static_cast<float>(sums.position[a] / sums.count);
  }
  std::array<float, 3> cube{};
  const bool corner = params_.radius == RadiusRule::kCorner;
  if (params_.paper_mode || corner) cube = cubeCenter(window, cell);
  const DiscReach reach = discReach(window, cell, params_.paper_mode ? cube : row.center);
  if (params_.paper_mode) takePoint(window, reach.nearest, row, normal);
  for (std::size_t a = 0; a < 3; ++a) row.normal[a] = static_cast<float>(normal.normal[a]);
  row.reach = reach.farthest;
  if (corner) {
    row.reach =
        static_cast<float>(cornerRadius({row.center[0], row.center[1], row.center[2]},
                                        {cube[0], cube[1], cube[2]}, cloud_.edge(cell.shift)));
  }
  row.spacing = cell.spacing;
  if (!(row.spacing > 0)) row.spacing = static_cast<float>(spacingAround(cloud_, window, cell));
  row.confidence = static_cast<float>(sums.count);
  row.normal_variance = static_cast<float>(normal.variance);
  const std::size_t input = source_.cloud.inputIndex(window.order(reach.nearest));
  row.rgb = colorOf(sums, input);
  row.kept = static_cast<std::uint32_t>(input);
  return row;
}

std::array<float, 3> SplatBuilder::cubeCenter(const PointWindow& window,
                                              const OctreeCell& cell) const {
  const auto center = cloud_.center(window.position(cell.begin), cell.shift);
  return {static_cast<float>(center[0]), static_cast<float>(center[1]),
          static_cast<float>(center[2])};
}

/** Paper mode: the disc is at the kept point, with its normal if it has one. */
void SplatBuilder::takePoint(const PointWindow& window, std::size_t point, Row& row,
                             DiscNormal& normal) {
  row.center = window.position(point);
  const auto own = window.normal(point);
  const float sq = own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
  for (std::size_t a = 0; a < 3 && sq > 0.5f; ++a) normal.normal[a] = own[a];
}

SplatSet::Gradient SplatBuilder::gradientOf(const PointWindow& window, const OctreeCell& cell,
                                            const CellSums& sums, const DiscNormal& normal) const {
  if (!source_.colors.bgr) return {};
  return discGradient(window, cell, sums, normal.normal, source_.table, color_noise_,
                      cloud_.cell());
}

std::uint32_t SplatBuilder::colorOf(const CellSums& sums, std::size_t input) const {
  if (!source_.colors.bgr) return 0xffffffu;
  if (params_.color == SplatColor::kOwn || sums.count < 2) {
    const unsigned char* bgr =
        static_cast<const unsigned char*>(source_.colors.bgr) + input * source_.colors.stride;
    return static_cast<std::uint32_t>(bgr[2] << 16 | bgr[1] << 8 | bgr[0]);
  }
  float lab[3];
  for (int a = 0; a < 3; ++a) lab[a] = static_cast<float>(sums.lab[a] / sums.count);
  const auto rgb = source_.table.rgb(lab);
  return static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
}

void SplatBuilder::count(SplatStatistics& statistics) const {
  for (const Slice& slice : slices_) {
    statistics.splats += slice.rows.size();
    statistics.single_points += slice.single_points;
    statistics.without_normal += slice.without_normal;
  }
}

/** Widest spacing by some thousand cells, whose median is close to that of all. */
double SplatBuilder::widest() const {
  std::size_t total = 0, number = 0;
  for (const Slice& slice : slices_) total += slice.rows.size();
  const std::size_t stride = std::max<std::size_t>(1, total / kSpacingCells);
  std::vector<CellSpacing> cells;
  for (const Slice& slice : slices_) {
    const std::size_t skip = (stride - number % stride) % stride;
    for (std::size_t r = skip; r < slice.rows.size(); r += stride) {
      cells.push_back(
          {slice.rows[r].spacing, static_cast<std::uint32_t>(slice.rows[r].confidence)});
    }
    number += slice.rows.size();
  }
  return widestSpacing(cells);
}

std::vector<float> SplatBuilder::neighborRadiiOf(const PointStore& store, double widest) const {
  std::vector<std::uint32_t> first(1, 0), disc_of(disc_of_.size());
  std::vector<std::array<float, 3>> centers;
  for (const Slice& slice : slices_) {
    for (const Row& row : slice.rows) centers.push_back(row.center);
    first.push_back(static_cast<std::uint32_t>(centers.size()));
  }
  for (std::size_t i = 0; i < disc_of.size(); ++i)
    disc_of[i] = first[disc_of_[i][0]] + disc_of_[i][1];
  return neighborRadii(cloud_, centers, disc_of, store, widest, params_.threads);
}

/** Radius of a disc in root cells. */
double SplatBuilder::radiusOf(const Row& row, double widest) const {
  if (params_.radius != RadiusRule::kDensity) return row.reach;
  const double bend = std::sqrt(std::max(0.0, row.normal_variance - kNoiseSlack * normal_noise_));
  return densityRadius(row.reach, row.confidence, bend, row.spacing, widest);
}

/** Writes one disc in world units. */
void SplatBuilder::write(const Row& row, double radius, std::size_t i, SplatSet& splats) const {
  const auto cell = static_cast<float>(cloud_.cell());
  splats.x[i] = row.center[0] * cell;
  splats.y[i] = row.center[1] * cell;
  splats.z[i] = row.center[2] * cell;
  splats.nx[i] = row.normal[0];
  splats.ny[i] = row.normal[1];
  splats.nz[i] = row.normal[2];
  splats.radius[i] = static_cast<float>(radius * cloud_.cell());
  splats.rgb[i] = row.rgb;
  splats.confidence[i] = row.confidence;
  splats.normal_variance[i] = row.normal_variance;
  splats.kept[i] = row.kept;
}

void SplatBuilder::finish(const PointStore* store, SplatSet& splats, SplatStatistics& statistics) {
  count(statistics);
  const double widest_spacing = widest();
  statistics.spacing = widest_spacing / kWidestSpacings * cloud_.cell();
  std::vector<float> radii;
  if (store && params_.radius == RadiusRule::kNeighbors)
    radii = neighborRadiiOf(*store, widest_spacing);
  std::vector<std::size_t> first(1, 0);
  for (const Slice& slice : slices_) first.push_back(first.back() + slice.rows.size());
  splats.origin = cloud_.frame().origin;
  splats.resize(first.back(), params_.color == SplatColor::kGradient);
  parallelFor(slices_.size(), params_.threads, 8, [&](std::size_t s, int) {
    for (std::size_t r = 0; r < slices_[s].rows.size(); ++r) {
      const Row& row = slices_[s].rows[r];
      const std::size_t i = first[s] + r;
      const double radius = radii.empty() ? radiusOf(row, widest_spacing) : radii[i];
      write(row, radius, i, splats);
      if (splats.gradient.empty()) continue;
      splats.gradient[i] = slices_[s].gradients[r];
      const auto held = static_cast<float>(std::min(1.0, kFollowed * row.reach / radius));
      for (float& value : splats.gradient[i]) value *= held;
    }
  });
}

}  // namespace pcl_slim::detail

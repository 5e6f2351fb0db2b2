// SPDX-License-Identifier: BSD-3-Clause
// Patches of points, and the residuals of cubics on them (docs/noise.md, and
// docs/theory.md, "Sheets, without normals").
#include "noise/patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kLeastSide = 1;  ///< least number of points of a sheet

/** Two parallel sheets of a patch. */
struct SheetPair {
  Eigen::Vector3d normal;  ///< of both
  double middle = 0;       ///< height between them, relative to the sample
};

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axesOf(const Eigen::Matrix3d& matrix) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(matrix);
  return axes;
}

Eigen::Matrix3d covarianceOf(const PatchSums& sums, std::size_t count) {
  const double share = 1 / static_cast<double>(count);
  return share * sums.second - (share * sums.first) * (share * sums.first).transpose();
}

/** Two-means on heights. Each pass takes the normal from the covariance within the two sheets. */
SheetPair pairSheets(const PatchPoints& points, int passes, double* heights) {
  const PatchSums all = kernels::sumPatch(points);
  SheetPair pair{axesOf(covarianceOf(all, points.size())).eigenvectors().col(0), 0};
  const auto n = static_cast<double>(points.size());
  pair.middle = pair.normal.dot(all.first) / n;
  Eigen::Vector3d above, last_above = Eigen::Vector3d::Zero();
  std::size_t last_count = 0;
  for (int pass = 0; pass < passes; ++pass) {
    kernels::heightsAlong(points, pair.normal, heights);
    const std::size_t count = kernels::sumAbove(points, heights, pair.middle, above);
    if (count < kLeastSide || points.size() - count < kLeastSide) break;
    if (count == last_count && above == last_above) break;  // no point has changed sides
    last_count = count;
    last_above = above;
    const auto a = static_cast<double>(count);
    const Eigen::Vector3d below = (all.first - above) / (n - a);
    above /= a;
    const Eigen::Matrix3d within =
        all.second - a * above * above.transpose() - (n - a) * below * below.transpose();
    pair.normal = axesOf(within).eigenvectors().col(0);
    pair.middle = 0.5 * pair.normal.dot(above + below);
  }
  return pair;
}

}  // namespace

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principalAxes(const PatchPoints& points) {
  return axesOf(covarianceOf(kernels::sumPatch(points), points.size()));
}

bool keepOwnSheet(const PatchSheetConstants& constants, Patch& patch) {
  const std::size_t n = patch.points.size();
  if (n < 2 * kLeastSide) return false;
  thread_local AlignedVector<double> heights;
  heights.resize(n + kPadding);
  const SheetPair pair = pairSheets(patch.points, constants.passes, heights.data());
  kernels::heightsAlong(patch.points, pair.normal, heights.data());
  const HeightGap gap = kernels::gapAbout(heights.data(), n, pair.middle);
  if (n - gap.above < kLeastSide || gap.above < kLeastSide) return false;
  const double spread = std::max(gap.end_below - gap.lowest, gap.highest - gap.begin_above);
  if (gap.begin_above - gap.end_below < constants.gap * spread) return false;
  std::size_t kept = 0;
  double radius_sq = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // The sample is at height 0.
    if ((heights[i] > pair.middle) != (0.0 > pair.middle)) continue;
    const Eigen::Vector3d p = patch.points.at(i);
    patch.points.set(kept++, p);
    radius_sq = std::max(radius_sq, p.squaredNorm());
  }
  patch.points.cut(kept);
  patch.radius = std::sqrt(radius_sq);
  return true;
}

namespace {

/// Relative ridge that keeps the normal equations of points on a line regular. It is below the
/// accuracy of other patches.
constexpr double kRidge = 1e-12;

/** Index of the term u^(degree - p) v^p in graded order. */
constexpr std::size_t gradedIndex(int degree, int p) {
  return static_cast<std::size_t>(degree * (degree + 1) / 2 + p);
}

/** Part of the noise variance that the points in a ball have.
 * \param[in] q their residual variance over the squared radius of the ball */
double partLeft(double q) {
  constexpr double kFull = 0.12;  // q of a ball that noise fills uniformly
  q = std::min(q, kFull);
  return 1 - 2 * q - 22 * q * q;
}

}  // namespace

bool fitCubic(const Patch& patch, PatchCubic& cubic) {
  const std::size_t n = patch.points.size();
  if (n <= kCubicTerms + 1) return false;
  const Eigen::Matrix3d axes = principalAxes(patch.points).eigenvectors();
  kernels::turnPatch(patch.points, axes / patch.radius, cubic.places);
  const CubicSums sums = kernels::sumCubic(cubic.places);
  Eigen::Matrix<double, kCubicTerms, kCubicTerms> normal;
  Eigen::Matrix<double, kCubicTerms, 1> right;
  for (int j = 0, degree = 0; degree <= 3; ++degree) {
    for (int v = 0; v <= degree; ++v, ++j) {
      right[j] = sums.heights[static_cast<std::size_t>(j)];
      for (int k = 0, other = 0; other <= 3; ++other) {
        for (int w = 0; w <= other; ++w, ++k)
          normal(j, k) = sums.moments[gradedIndex(degree + other, v + w)];
      }
    }
  }
  normal.diagonal().array() *= 1.0 + kRidge;
  const Eigen::Matrix<double, kCubicTerms, 1> solution = normal.ldlt().solve(right);
  double terms[kCubicTerms];
  std::copy_n(solution.data(), kCubicTerms, terms);
  cubic.residuals.resize(n + kPadding);
  const double rss = kernels::cubicResiduals(cubic.places, terms, cubic.residuals.data());
  cubic.variance = rss / static_cast<double>(n - kCubicTerms) * patch.radius * patch.radius;
  return std::isfinite(cubic.variance);
}

void patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
                Patch& patch, double about) {
  thread_local std::vector<std::uint32_t> neighbors;
  patch.radius = std::sqrt(search.nearestSet(sample, k, neighbors, static_cast<float>(about)));
  patch.points.resize(neighbors.size());
  const auto center = store.position(sample);
  std::size_t count = 0;
  for (const std::uint32_t j : neighbors) {
    if (store.hasSides()) {
      const auto a = store.normal(sample), b = store.normal(j);
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] <= 0.0f) continue;
    }
    const auto p = store.position(j);
    patch.points.set(count++, {p[0] - center[0], p[1] - center[1], p[2] - center[2]});
  }
  patch.points.cut(count);
}

namespace {

/** Fits a cubic to the patch of k points around a sample, without the points of another sheet.
 * \return false if there are too few points
 * \param[in] search contains every patchStride(k)-th point
 * \param[in] about as in NeighborSearch::nearestSet() \param[out] radius of the patch */
bool fitPatch(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
              const NoiseConstants& constants, PatchCubic& cubic, double& radius,
              double about = 0) {
  k /= patchStride(k, constants);
  thread_local Patch patch;
  patchAbout(store, search, sample, k, patch, about);
  const double wider =
      probableSquare(patch.radius, static_cast<double>(constants.sheets.neighbor_factor));
  if (!store.hasNormals() && keepOwnSheet(constants.sheets, patch)) {
    // Half of the neighbours were of another sheet. Twice as many restore the size of the patch.
    patchAbout(store, search, sample, constants.sheets.neighbor_factor * k, patch, wider);
    keepOwnSheet(constants.sheets, patch);
  }
  radius = patch.radius;
  return fitCubic(patch, cubic);
}

}  // namespace

double patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample,
                     std::size_t k, const NoiseConstants& constants, double& radius) {
  thread_local PatchCubic cubic;
  return fitPatch(store, search, sample, k, constants, cubic, radius) ? cubic.variance : -1.0;
}

void restoreCutVariances(const std::vector<double>& radii, const NoiseConstants& constants,
                         int threads, std::vector<double>& variances) {
  std::vector<double> parts(variances.size(), -1);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (variances[s] >= 0 && radii[s] > 0) parts[s] = variances[s] / (radii[s] * radii[s]);
  }
  const std::vector<float> means = windowedMeans(parts, constants, threads);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (variances[s] > 0) variances[s] /= partLeft(means[s]);
  }
}

double uncutVariance(double variance, double radius) {
  return radius > 0 ? variance / partLeft(variance / (radius * radius)) : variance;
}

namespace {

constexpr double kLeastWidth = 0.5;  ///< least ratio of width and length of a patch that is no line
constexpr std::size_t kWindow = 8;   ///< number of values to either side in a window

}  // namespace

std::size_t smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads) {
  const std::size_t first = constants.first_neighbors;
  for (std::size_t k = first; k <= first + store.size() / constants.most_part; k *= 2) {
    const std::size_t stride = patchStride(k, constants);
    const auto width = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
      thread_local Patch patch;
      patchAbout(store, search, sample, k / stride, patch);
      const Eigen::Vector3d spreads = principalAxes(patch.points).eigenvalues();
      return spreads[2] > 0 ? std::sqrt(std::max(0.0, spreads[1] / spreads[2])) : 0.0;
    };
    auto widths = sampleStore(store, constants.least_samples, stride, threads, width);
    if (median(widths) >= kLeastWidth) return k;
  }
  return first;
}

double trimmedMean(std::vector<double>& values, double trim) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return v < 0.0; }),
               values.end());
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(trim * static_cast<double>(values.size()));
  double sum = 0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

double trimmedMeanError(std::vector<double> values, double trim) {
  const double mean = trimmedMean(values, trim);
  if (values.size() < 2 || !(mean > 0)) return 0;
  const auto n = static_cast<double>(values.size());
  const auto cut = static_cast<std::size_t>(trim * n);
  const double low = values[cut], high = values[values.size() - cut - 1];
  double sum = 0, squares = 0;
  for (const double value : values) {
    const double kept = std::clamp(value, low, high);
    sum += kept;
    squares += kept * kept;
  }
  const double variance = std::max(0.0, squares - sum * sum / n) / (n - 1);
  return std::sqrt(variance / n) / ((1 - 2 * trim) * mean);
}

std::pair<std::size_t, std::size_t> windowAround(std::size_t place, std::size_t places) {
  return {place - std::min(place, kWindow), std::min(places, place + kWindow + 1)};
}

std::vector<float> windowedMeans(const std::vector<double>& values, const NoiseConstants& constants,
                                 int threads) {
  constexpr std::size_t kTask = 128;
  std::vector<float> means(values.size(), 1.0f);
  parallelFor(values.size(), threads, kTask, [&](std::size_t s, int) {
    thread_local std::vector<double> window;
    const auto [first, end] = windowAround(s, values.size());
    window.assign(&values[first], &values[first] + (end - first));
    means[s] = static_cast<float>(trimmedMean(window, constants.trim));
  });
  return means;
}

namespace {

/** Sums over square cells of a patch's plane. */
class PatchCells {
 public:
  /** \param[in] cells number of cells with the area of the unit disc */
  explicit PatchCells(double cells)
      : side_(static_cast<int>(std::ceil(2 / std::sqrt(kDisc / cells)))),
        per_width_(1 / std::sqrt(kDisc / cells)),
        cells_(static_cast<std::size_t>(side_ * side_)) {}

  void add(double u, double v, double residual) {
    Cell& cell = cells_[static_cast<std::size_t>(place(v) * side_ + place(u))];
    cell.count += 1;
    cell.sum += residual;
    squares_ += residual * residual;
  }

  /** \return sum of the products over all pairs in a cell, each point with itself too, over the sum
   * of squares \param[out] partners mean number of other points in the cell of a point */
  double shared(double& partners) const {
    double products = 0, pairs = 0, points = 0;
    for (const Cell& cell : cells_) {
      products += cell.sum * cell.sum;
      pairs += cell.count * (cell.count - 1);
      points += cell.count;
    }
    partners = pairs / points;
    return products / squares_;
  }

  bool empty() const { return !(squares_ > 0); }

 private:
  static constexpr double kDisc = M_PI;

  struct Cell {
    double count = 0, sum = 0;
  };

  int place(double coordinate) const {
    return std::clamp(static_cast<int>((coordinate + 1) * per_width_), 0, side_ - 1);
  }

  int side_;
  double per_width_;
  std::vector<Cell> cells_;
  double squares_ = 0;
};

/** Correlation of errors that are averages over w x w points: w^2. A cell of c x c points contains
 * only w - (w^2 - 1) / 3 c of w along each side, which this function inverts.
 * \param[in] shared sharedInPatch() of cells \param[in] points number of points in a cell: c^2 */
double correctedForCells(double shared, double points) {
  const double third = 1 / (3 * std::sqrt(points)), side = std::sqrt(std::max(1.0, shared));
  const double root = std::max(0.0, 1 - 4 * third * (side - third));
  const double width = (1 - std::sqrt(root)) / (2 * third);
  return width * width;
}

/** Correlation of the residuals within square cells of a patch: the sum of products over all pairs
 * of points in a cell, over the sum of squares. \return 1 for white noise; < 0: unknown */
double sharedInPatch(const PatchCubic& cubic, double num_cells) {
  PatchCells cells(num_cells);
  const std::size_t n = cubic.places.size();
  for (std::size_t i = 0; i < n; ++i)
    cells.add(cubic.places[2][i], cubic.places[1][i], cubic.residuals[i]);
  if (cells.empty()) return -1;
  double partners;
  const double shared = cells.shared(partners);
  // The fit of the cubic reduces the covariance of neighbouring residuals by this share.
  const double lost = kCubicTerms * partners / static_cast<double>(n);
  return lost < 1 ? shared / (1 - lost) : -1.0;
}

/** Every second point of a store. \param[in] first 0 or 1 */
PointStore everySecond(const PointStore& store, std::size_t first, int threads) {
  std::vector<std::uint32_t> dropped;
  dropped.reserve(store.size() / 2 + 1);
  for (std::size_t i = 1 - first; i < store.size(); i += 2)
    dropped.push_back(static_cast<std::uint32_t>(i));
  return store.without(dropped, threads);
}

}  // namespace

double PatchScale::power(std::size_t place) const {
  // The correlation among all points is stride times that among every stride-th point.
  const double sharing = 1 + static_cast<double>(stride) * (shared[place] - 1);
  return variances[place] * std::max(1.0, sharing);
}

ThinnedPlaces::ThinnedPlaces(const PointStore& store, std::size_t count) : whole_(store) {
  count = std::min(count, store.size());
  for (std::size_t s = 0; s < count; ++s)
    places_.push_back((2 * s + 1) * store.size() / (2 * count));
}

void ThinnedPlaces::thinTo(std::size_t stride, int threads) {
  for (; stride_ < stride; stride_ *= 2) {
    const std::size_t before = stride_ == 1 ? 1 : parts_.size();
    const std::size_t parts = stride_ < kOnePartStride ? 1 : std::min(2 * before, kMostParts);
    std::vector<PointStore> thinner;
    for (std::size_t p = 0; p < parts; ++p)
      thinner.push_back(everySecond(storeOf(p % before), p / before, threads));
    parts_ = std::move(thinner);
    for (std::size_t s = 0; s < places_.size(); ++s)
      places_[s] = std::min(places_[s] / 2, parts_[s % parts_.size()].size() - 1);
  }
}

PatchScale measureScale(ThinnedPlaces& points, std::size_t k, const NoiseConstants& constants,
                        int threads, const PatchScale* narrower, const PlaceLook& look) {
  PatchScale scale;
  if (look.seen != nullptr) {
    scale = *look.seen;
  } else {
    scale.k = k;
    scale.stride = patchStride(k, constants);
    scale.variances.assign(points.size(), -1);
    scale.shared.assign(points.size(), -1);
    scale.radii.resize(points.size());
  }
  points.thinTo(scale.stride, threads);
  points.forEach(threads, [&](const PointStore& store, NeighborSearch& search, std::size_t place,
                              std::size_t s) {
    if (look.isFirst(s) == (look.seen != nullptr)) return;
    thread_local PatchCubic cubic;
    const double factor = narrower ? static_cast<double>(k) / static_cast<double>(narrower->k) : 0;
    const double about = narrower ? probableSquare(narrower->radii[s], factor) : 0;
    const bool fits =
        fitPatch(store, search, place, k / scale.stride, constants, cubic, scale.radii[s], about);
    if (!fits) return;
    scale.variances[s] = cubic.variance;
    scale.shared[s] = sharedInPatch(cubic, constants.shared.cells);
  });
  return scale;
}

PatchScale measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                        int threads) {
  ThinnedPlaces points(store, constants.shared.places);
  return measureScale(points, k, constants, threads);
}

double levelOf(const PatchScale& scale, const NoiseConstants& constants) {
  std::vector<double> variances = scale.variances;
  return uncutVariance(trimmedMean(variances, constants.shared.trim), median(scale.radii));
}

double correlationOf(const PatchScale& scale, const NoiseConstants& constants) {
  std::vector<double> shared = scale.shared;
  const std::size_t used = scale.k / scale.stride;
  const double points = static_cast<double>(used) / static_cast<double>(constants.shared.cells);
  const double among = correctedForCells(trimmedMean(shared, constants.shared.trim), points);
  return 1 + static_cast<double>(scale.stride) * (among - 1);
}

}  // namespace pcl_slim::detail

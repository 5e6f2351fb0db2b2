// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

constexpr double kRidge = 1e-12;  ///< keeps patches that are a line solvable; moves no digit

/** Place of u^(degree - v) v^v in graded order. */
constexpr std::size_t
gradedIndex(int degree, int v)
{
  return static_cast<std::size_t>(degree * (degree + 1) / 2 + v);
}

/** Part of noise's variance that a ball's residuals show. \param[in] q theirs over its squared radius */
double
partLeft(double q)
{
  constexpr double kFull = 0.12;  // of a ball full of points
  q = std::min(q, kFull);
  return 1 - 2 * q - 22 * q * q;
}

}  // namespace

bool
fitCubic(const Patch& patch, PatchCubic& cubic)
{
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

void
patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
           Patch& patch, double about)
{
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

bool
fitPatch(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
         const NoiseConstants& constants, PatchCubic& cubic, double& radius, double about)
{
  k /= patchStride(k, constants);
  thread_local Patch patch;
  patchAbout(store, search, sample, k, patch, about);
  const double wider = probableSquare(patch.radius, static_cast<double>(constants.sheets.factor));
  if (!store.hasNormals() && keepOwnSheet(constants.sheets, patch)) {
    // Half the neighbours are of another sheet: twice as many restore the patch's size.
    patchAbout(store, search, sample, constants.sheets.factor * k, patch, wider);
    keepOwnSheet(constants.sheets, patch);
  }
  radius = patch.radius;
  return fitCubic(patch, cubic);
}

double
patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
              const NoiseConstants& constants, double& radius)
{
  thread_local PatchCubic cubic;
  return fitPatch(store, search, sample, k, constants, cubic, radius) ? cubic.variance : -1.0;
}

void
putBackCutOff(const std::vector<double>& radii, const NoiseConstants& constants, int threads,
              std::vector<double>& variances)
{
  std::vector<double> parts(variances.size(), -1);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (variances[s] >= 0 && radii[s] > 0) parts[s] = variances[s] / (radii[s] * radii[s]);
  }
  const std::vector<float> means = windowedMeans(parts, constants, threads);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (variances[s] > 0) variances[s] /= partLeft(means[s]);
  }
}

double
uncutVariance(double variance, double radius)
{
  return radius > 0 ? variance / partLeft(variance / (radius * radius)) : variance;
}

std::size_t
smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads)
{
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
    if (median(widths) >= constants.least_width) return k;
  }
  return first;
}

double
trimmedMean(std::vector<double>& values, double trim)
{
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return v < 0.0; }),
               values.end());
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(trim * static_cast<double>(values.size()));
  double sum = 0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

double
trimmedMeanError(std::vector<double> values, double trim)
{
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

}  // namespace pcl_slim::detail

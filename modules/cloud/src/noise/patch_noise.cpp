// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch_noise.h"

#include <Eigen/Dense>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kRidge = 1e-12;  ///< keeps patches that are a line solvable; moves no digit

}  // namespace

bool
fitCubic(const Patch& patch, PatchCubic& cubic)
{
  const Eigen::Index n = patch.points.cols();
  if (n <= kCubicTerms + 1) return false;
  const Eigen::Matrix3d axes = principalAxes(patch.points).eigenvectors();
  cubic.places = axes.transpose() * patch.points / patch.radius;
  const Eigen::Matrix3Xd& local = cubic.places;
  Eigen::Matrix<double, Eigen::Dynamic, kCubicTerms> terms(n, kCubicTerms);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = local(2, i), v = local(1, i);
    terms.row(i) << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v;
  }
  const Eigen::VectorXd heights = local.row(0).transpose();
  Eigen::Matrix<double, kCubicTerms, kCubicTerms> normal = terms.transpose() * terms;
  normal.diagonal().array() *= 1.0 + kRidge;
  const Eigen::Matrix<double, kCubicTerms, 1> c = normal.ldlt().solve(terms.transpose() * heights);
  cubic.residuals = heights - terms * c;
  const double rss = cubic.residuals.squaredNorm();
  cubic.variance = rss / static_cast<double>(n - kCubicTerms) * patch.radius * patch.radius;
  return std::isfinite(cubic.variance);
}

Patch
patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k)
{
  thread_local std::vector<std::uint32_t> neighbors;
  thread_local std::vector<float> distances_sq;
  search.nearest(sample, k, neighbors, distances_sq);
  Patch patch;
  patch.radius = std::sqrt(distances_sq.back());
  patch.points.resize(3, static_cast<Eigen::Index>(neighbors.size()));
  const auto center = store.position(sample);
  Eigen::Index count = 0;
  for (const std::uint32_t j : neighbors) {
    if (store.hasSides()) {
      const auto a = store.normal(sample), b = store.normal(j);
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] <= 0.0f) continue;
    }
    const auto p = store.position(j);
    patch.points.col(count++) << p[0] - center[0], p[1] - center[1], p[2] - center[2];
  }
  patch.points.conservativeResize(3, count);
  return patch;
}

bool
fitPatch(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
         const NoiseConstants& constants, PatchCubic& cubic, double& radius)
{
  k /= patchStride(k, constants);
  Patch patch = patchAbout(store, search, sample, k);
  if (!store.hasNormals() && keepOwnSheet(constants.sheets, patch)) {
    // Half the neighbours lay on another sheet: twice as many give the patch its size back.
    patch = patchAbout(store, search, sample, constants.sheets.factor * k);
    keepOwnSheet(constants.sheets, patch);
  }
  radius = patch.radius;
  return fitCubic(patch, cubic);
}

double
patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
              const NoiseConstants& constants, double& radius)
{
  PatchCubic cubic;
  return fitPatch(store, search, sample, k, constants, cubic, radius) ? cubic.variance : -1.0;
}

std::size_t
smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads)
{
  const std::size_t first = constants.first_neighbors;
  for (std::size_t k = first; k <= first + store.size() / constants.most_part; k *= 2) {
    const std::size_t stride = patchStride(k, constants);
    const auto width = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
      const Patch patch = patchAbout(store, search, sample, k / stride);
      const Eigen::Vector3d spreads = principalAxes(patch.points).eigenvalues();
      return spreads[2] > 0 ? std::sqrt(std::max(0.0, spreads[1] / spreads[2])) : 0.0;
    };
    auto widths = sampleStore(store, constants.least_samples, stride, threads, width);
    const auto median = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), median, widths.end());
    if (*median >= constants.least_width) return k;
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

}  // namespace pcl_slim::detail

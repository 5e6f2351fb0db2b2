// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/noise_level.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kResidualSamples = 500;
constexpr std::size_t kLeastSamples = 100;
constexpr std::size_t kScouts = 25;  ///< samples that tell whether noise fills patches
constexpr std::size_t kEigenvalueSamples = 1000;
constexpr std::size_t kFirstNeighbors = 20;
constexpr std::size_t kMostNeighbors = 20480;
constexpr std::size_t kPatchPoints = 320;  ///< looked at in a patch: larger ones are sampled
constexpr int kCubicTerms = 10;
constexpr double kPatchNoise = 0.2;      ///< noise above this share of the patch's radius fills it
constexpr double kFilledPatch = 0.25;    ///< below this share noise no longer fills it
constexpr double kDetail = 0.9;          ///< of that share in twice as many points: noise has .8
constexpr std::size_t kSheetFactor = 2;  ///< neighbours asked for where two sheets share a patch
constexpr double kTrim = 0.1;
constexpr std::size_t kPointsPerRun = 128, kMostRuns = 8192;  ///< of a noise profile
constexpr std::size_t kWindow = 8;     ///< runs to either side that its entries rest on
constexpr float kLeastShare = 0.001f;  ///< of the cloud's noise
constexpr double kBiasGrowth =
    16.0;  ///< of a cubic's squared bias when k, and so radius^2, doubles
constexpr double kLeastNoise = 1e-4;  ///< share of the residual that is always taken for noise
constexpr double kFloor = 1e-11;      ///< of L

Patch
neighborhood(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
             std::vector<std::uint32_t>& neighbors, std::vector<float>& distances_sq)
{
  search.nearest(sample, k, neighbors, distances_sq);
  Patch patch;
  patch.radius = std::sqrt(distances_sq.back());
  patch.points.resize(3, static_cast<Eigen::Index>(neighbors.size()));
  const auto center = store.position(sample);
  Eigen::Index count = 0;
  for (const std::uint32_t j : neighbors) {
    if (store.hasNormals()) {
      const auto a = store.normal(sample), b = store.normal(j);
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] <= 0.0f) continue;
    }
    const auto p = store.position(j);
    patch.points.col(count++) << p[0] - center[0], p[1] - center[1], p[2] - center[2];
  }
  patch.points.conservativeResize(3, count);
  return patch;
}

/** Residual variance of a cubic height field over the patch's two main axes; < 0: too few points. */
double
cubicResidual(const Patch& patch)
{
  const Eigen::Index n = patch.points.cols();
  if (n <= kCubicTerms + 1) return -1.0;
  const Eigen::Matrix3d axes = principalAxes(patch.points).eigenvectors();
  const Eigen::Matrix3Xd local = axes.transpose() * patch.points / patch.radius;
  Eigen::Matrix<double, Eigen::Dynamic, kCubicTerms> terms(n, kCubicTerms);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = local(2, i), v = local(1, i);
    terms.row(i) << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v;
  }
  const Eigen::VectorXd heights = local.row(0).transpose();
  Eigen::Matrix<double, kCubicTerms, kCubicTerms> normal = terms.transpose() * terms;
  normal.diagonal().array() *= 1.0 + 1e-12;
  const Eigen::Matrix<double, kCubicTerms, 1> c = normal.ldlt().solve(terms.transpose() * heights);
  const double rss = (heights - terms * c).squaredNorm();
  const double variance = rss / static_cast<double>(n - kCubicTerms) * patch.radius * patch.radius;
  return std::isfinite(variance) ? variance : -1.0;
}

double
trimmedMean(std::vector<double>& values)
{
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return v < 0.0; }),
               values.end());
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(kTrim * static_cast<double>(values.size()));
  double sum = 0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

/** Of the points looked at for patches of k. */
std::size_t
patchStride(std::size_t k)
{
  return std::max<std::size_t>(1, k / kPatchPoints);
}

/** Calls measure(search, sample, s) at evenly strided points, s counting them. */
template <typename Measure>
std::vector<double>
sampleStore(const PointStore& store, std::size_t samples, std::size_t stride, int threads,
            const Measure& measure)
{
  samples = std::min(samples, store.size());
  std::vector<double> values(samples);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads),
                                       NeighborSearch(store, stride));
  parallelFor(samples, threads, 4, [&](std::size_t s, int thread) {
    const std::size_t sample = (2 * s + 1) * store.size() / (2 * samples);
    values[s] = measure(searches[static_cast<std::size_t>(thread)], sample, s);
  });
  return values;
}

/** Trimmed residual variance over patches of k points, and their median radius. */
struct PatchNoise {
  double variance = 0, radius = 0;
  std::size_t neighbors = 0;
};

/** \param[in] search over every patchStride(k)-th point */
double
patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
              double& radius)
{
  k /= patchStride(k);
  thread_local std::vector<std::uint32_t> neighbors;
  thread_local std::vector<float> distances_sq;
  Patch patch = neighborhood(store, search, sample, k, neighbors, distances_sq);
  if (!store.hasNormals() && keepOwnSheet(patch)) {
    // Half the neighbours lay on another sheet: twice as many give the patch its size back.
    patch = neighborhood(store, search, sample, kSheetFactor * k, neighbors, distances_sq);
    keepOwnSheet(patch);
  }
  radius = patch.radius;
  return cubicResidual(patch);
}

PatchNoise
patchNoise(const PointStore& store, std::size_t k, std::size_t samples, int threads)
{
  std::vector<double> radii(std::min(samples, store.size()));
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
    return patchVariance(store, search, sample, k, radii[s]);
  };
  auto values = sampleStore(store, samples, patchStride(k), threads, measure);
  const auto median = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), median, radii.end());
  return {trimmedMean(values), *median, k};
}

PatchNoise
patchNoise(const PointStore& store, std::size_t k, int threads)
{
  // Larger patches average more points each, so fewer of them are needed.
  const std::size_t samples = std::max(kLeastSamples, kResidualSamples * kFirstNeighbors / k);
  return patchNoise(store, k, samples, threads);
}

/** The first number of neighbours whose patches are not plainly full of noise. */
std::size_t
leastNeighbors(const PointStore& store, std::size_t most, int threads)
{
  std::size_t k = kFirstNeighbors;
  for (; 2 * k <= most; k *= 2) {
    const PatchNoise noise = patchNoise(store, k, kScouts, threads);
    if (std::sqrt(noise.variance) < kFilledPatch * noise.radius) break;
  }
  return k;
}

/** The cloud's noise, and how large a patch has to be to show it. */
PatchNoise
residualNoise(const PointStore& store, int threads)
{
  const std::size_t most = std::min(kMostNeighbors, store.size() / 8 + kFirstNeighbors);
  const std::size_t least = leastNeighbors(store, most, threads);
  PatchNoise noise = patchNoise(store, least, threads);
  for (std::size_t k = 2 * least; k <= most; k *= 2) {
    const PatchNoise wider = patchNoise(store, k, threads);
    // What grows like the eighth power of the patch's radius is the cubic's bias, not noise.
    const double bias_free = (kBiasGrowth * noise.variance - wider.variance) / (kBiasGrowth - 1);
    const double share = std::sqrt(noise.variance) / noise.radius;
    // Noise that no longer fills the patch loses in share as the patch widens; detail keeps its own.
    const bool detail =
        share < kFilledPatch && std::sqrt(wider.variance) > kDetail * share * wider.radius;
    if (share < kPatchNoise || detail) {
      noise.variance = std::clamp(bias_free, kLeastNoise * noise.variance, noise.variance);
      // A patch that ends at R cuts heights off: it sees s^2 (1 - 2 s^2 / R^2) of a variance s^2.
      noise.variance *= 1.0 + 2.0 * noise.variance / (noise.radius * noise.radius);
      break;
    }
    noise = wider;
  }
  const double floor = kFloor * store.diagonal();
  noise.variance = std::max(noise.variance, floor * floor);
  return noise;
}

double
eigenvalueNoise(const PointStore& store, int threads)
{
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    thread_local std::vector<std::uint32_t> neighbors;
    thread_local std::vector<float> distances_sq;
    const Patch patch = neighborhood(store, search, sample, 11, neighbors, distances_sq);
    if (patch.points.cols() < 4) return -1.0;
    return std::max(0.0, principalAxes(patch.points).eigenvalues()(0));
  };
  const auto values = sampleStore(store, kEigenvalueSamples, 1, threads, measure);
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    sum += std::max(value, 0.0);
    count += value >= 0.0;
  }
  const double floor = 1e-6 * store.diagonal();
  return std::max(count > 0 ? sum / static_cast<double>(count) : 0.0, floor * floor);
}

}  // namespace

double
estimateNoise(const PointStore& store, NoiseEstimator estimator, int threads)
{
  if (store.size() < kCubicTerms + 2) return 0.0;
  threads = resolveThreads(threads);
  return estimator == NoiseEstimator::kMinEigenvalue10 ? eigenvalueNoise(store, threads)
                                                       : residualNoise(store, threads).variance;
}

std::vector<float>
noiseProfile(const PointStore& store, int threads)
{
  if (store.size() < kCubicTerms + 2) return {};
  threads = resolveThreads(threads);
  const std::size_t k = residualNoise(store, threads).neighbors;
  const std::size_t samples =
      std::clamp(store.size() / kPointsPerRun, std::min(kLeastSamples, store.size()), kMostRuns);
  auto values = sampleStore(store, samples, patchStride(k), threads,
                            [&](NeighborSearch& search, std::size_t sample, std::size_t) {
                              double radius;
                              return patchVariance(store, search, sample, k, radius);
                            });
  std::vector<float> profile(samples, 1.0f);
  std::vector<double> window;
  const auto reach = static_cast<std::ptrdiff_t>(kWindow);
  for (std::ptrdiff_t s = 0; s < static_cast<std::ptrdiff_t>(samples); ++s) {
    const auto begin = values.begin() + std::max<std::ptrdiff_t>(0, s - reach);
    const auto end = values.begin() + std::min(static_cast<std::ptrdiff_t>(samples), s + reach + 1);
    window.assign(begin, end);
    profile[static_cast<std::size_t>(s)] = static_cast<float>(trimmedMean(window));
  }
  const double whole = trimmedMean(values);
  for (float& share : profile) {
    share = whole > 0 ? std::clamp(static_cast<float>(share / whole), kLeastShare, 1 / kLeastShare)
                      : 1.0f;
  }
  return profile;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise" and "Bias on clean data".
#include "pcl_slim/cloud/noise_level.h"

#include <algorithm>
#include <cmath>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim {

namespace detail {

namespace {

/** The noise of patches of k points: their trimmed mean variance and median radius. */
NoiseLevel
patchLevel(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads)
{
  // Larger patches average more points each, so fewer of them are needed.
  // No more patches of the smallest size are needed than contain each point once.
  const std::size_t smallest =
      std::max(std::min(constants.samples, store.size() / constants.first_neighbors),
               store.size() / constants.points_per_sample);
  const std::size_t samples =
      std::max(constants.least_samples, smallest * constants.first_neighbors / k);
  std::vector<double> radii(std::min(samples, store.size()));
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
    return patchVariance(store, search, sample, k, constants, radii[s]);
  };
  auto values = sampleStore(store, samples, patchStride(k, constants), threads, measure);
  putBackCutOff(radii, constants, threads, values);
  NoiseLevel level;
  level.error = 0.5 * trimmedMeanError(values, constants.trim);
  level.variance = trimmedMean(values, constants.trim);
  level.patch_radius = median(radii);
  level.neighbors = k;
  level.patches = radii.size();
  return level;
}

/** Takes the cubic's bias off, which a patch of twice as many points shows. */
void
removeBias(const NoiseLevel& wider, const NoiseConstants& constants, NoiseLevel& noise)
{
  const double growth = constants.bias_growth;
  const double bias_free = (growth * noise.variance - wider.variance) / (growth - 1);
  const double error =
      std::hypot(growth * noise.variance * noise.error, wider.variance * wider.error) /
      (growth - 1);
  noise.error = bias_free > error ? error / bias_free : 1;
  noise.variance = std::clamp(bias_free, 0.0, noise.variance);
}

}  // namespace

NoiseLevel
measureNoise(const PointStore& store, const NoiseConstants& constants, int threads)
{
  if (store.size() < kCubicTerms + 2) return {};
  threads = resolveThreads(threads);
  const std::size_t first = smallestPatch(store, constants, threads);
  const std::size_t most = store.size() / constants.most_part + first;
  NoiseLevel noise = patchLevel(store, first, constants, threads);
  std::size_t patches = noise.patches;
  for (std::size_t k = 2 * first; k <= most; k *= 2) {
    const NoiseLevel wider = patchLevel(store, k, constants, threads);
    patches += wider.patches;
    if (std::sqrt(noise.variance) < constants.patch_noise * noise.patch_radius) {
      removeBias(wider, constants, noise);
      break;
    }
    noise = wider;
  }
  const double floor = constants.floor * store.bulkDiagonal();
  if (noise.variance < floor * floor) noise.error = 0;
  noise.variance = std::max(noise.variance, floor * floor);
  noise.line = first > constants.first_neighbors ? first / 2 : 0;
  noise.patches = patches;
  return noise;
}

NoiseLevel
measurePaperNoise(const PointStore& store, const NoiseConstants& constants, int threads)
{
  if (store.size() < kCubicTerms + 2) return {};
  threads = resolveThreads(threads);
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    thread_local Patch patch;
    patchAbout(store, search, sample, constants.paper_neighbors + 1, patch);
    if (patch.points.size() < 4) return -1.0;
    return std::max(0.0, principalAxes(patch.points).eigenvalues()(0));
  };
  const auto values = sampleStore(store, constants.paper_samples, 1, threads, measure);
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    sum += std::max(value, 0.0);
    count += value >= 0.0;
  }
  const double floor = constants.paper_floor * store.diagonal();
  NoiseLevel noise;
  noise.variance = std::max(count > 0 ? sum / static_cast<double>(count) : 0.0, floor * floor);
  noise.neighbors = constants.paper_neighbors;
  noise.patches = values.size();
  return noise;
}

}  // namespace detail

double
estimateNoise(const PointStore& store, NoiseEstimator estimator, int threads)
{
  const bool paper = estimator == NoiseEstimator::kMinEigenvalue10;
  return (paper ? detail::measurePaperNoise(store, {}, threads)
                : detail::measureNoise(store, {}, threads))
      .variance;
}

}  // namespace pcl_slim

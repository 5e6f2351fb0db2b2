// SPDX-License-Identifier: BSD-3-Clause
// How noise varies along the Morton curve (docs/theory.md, "Noise").
#include <algorithm>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/cloud/noise_level.h"

namespace pcl_slim {

namespace detail {

std::vector<float>
windowedMeans(const std::vector<double>& values, const NoiseConstants& constants)
{
  std::vector<float> means(values.size(), 1.0f);
  std::vector<double> window;
  const auto reach = static_cast<std::ptrdiff_t>(constants.window);
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t s = 0; s < count; ++s) {
    window.assign(values.begin() + std::max<std::ptrdiff_t>(0, s - reach),
                  values.begin() + std::min(count, s + reach + 1));
    means[static_cast<std::size_t>(s)] = static_cast<float>(trimmedMean(window, constants.trim));
  }
  return means;
}

namespace {

std::size_t
numRuns(const PointStore& store, const NoiseConstants& constants)
{
  return std::clamp(store.size() / constants.points_per_run,
                    std::min(constants.least_samples, store.size()), constants.most_runs);
}

/** The variance of a patch of k points in every run. */
std::vector<double>
runVariances(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads)
{
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    double radius;
    return patchVariance(store, search, sample, k, constants, radius);
  };
  return sampleStore(store, numRuns(store, constants), patchStride(k, constants),
                     resolveThreads(threads), measure);
}

}  // namespace

std::vector<float>
measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                    const NoiseConstants& constants, int threads)
{
  if (level.neighbors == 0) return {};
  auto values = runVariances(store, level.neighbors, constants, threads);
  std::vector<float> profile = windowedMeans(values, constants);
  const double whole = trimmedMean(values, constants.trim);
  const float least = constants.least_ratio;
  for (float& ratio : profile) {
    ratio = whole > 0 ? std::clamp(static_cast<float>(ratio / whole), least, 1 / least) : 1.0f;
  }
  return profile;
}

std::vector<float>
measureRaisedProfile(const PointStore& store, const NoiseLevel& level,
                     const NoiseConstants& constants, int threads)
{
  if (level.neighbors == 0 || !(level.variance > 0)) return {};
  const std::size_t k = level.neighbors;
  std::vector<float> profile = windowedMeans(runVariances(store, k, constants, threads), constants);
  const std::vector<float> wider =
      windowedMeans(runVariances(store, 2 * k, constants, threads), constants);
  for (std::size_t j = 0; j < profile.size(); ++j) {
    const bool noise = isFlat(profile[j], wider[j], constants);
    const auto ratio = static_cast<float>(wider[j] / level.variance);
    profile[j] = noise ? std::clamp(ratio, 1.0f, 1 / constants.least_ratio) : 1.0f;
  }
  return profile;
}

std::vector<float>
modelledNoise(const PointStore& store, const RangeError& error, const NoiseConstants& constants,
              int threads)
{
  threads = resolveThreads(threads);
  const std::size_t k = smallestPatch(store, constants, threads);
  const std::size_t stride = patchStride(k, constants);
  const auto variance = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    const Patch patch = patchAbout(store, search, sample, k / stride);
    const Vector3 sensor = error.own_sensors ? store.sensor(sample) : error.sensor;
    const Vector3 ray = subtract(store.position(sample), sensor);
    const double z = length(ray), sigma = error.a + error.b * z + error.c * z * z;
    const Eigen::Vector3d normal = principalAxes(patch.points).eigenvectors().col(0);
    const double along = dot(ray, {normal[0], normal[1], normal[2]}) / std::max(z, 1e-300);
    return sigma * sigma * along * along;
  };
  return windowedMeans(sampleStore(store, numRuns(store, constants), stride, threads, variance),
                       constants);
}

}  // namespace detail

std::vector<float>
noiseProfile(const PointStore& store, int threads)
{
  const detail::NoiseConstants constants;
  return detail::measureNoiseProfile(store, detail::measureNoise(store, constants, threads),
                                     constants, threads);
}

}  // namespace pcl_slim

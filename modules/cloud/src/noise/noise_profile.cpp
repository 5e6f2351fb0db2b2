// SPDX-License-Identifier: BSD-3-Clause
// How noise varies along the Morton curve (docs/theory.md, "Noise").
#include <algorithm>

#include "noise/patch_noise.h"
#include "noise/patch_scale.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/cloud/noise_level.h"

namespace pcl_slim {

namespace detail {

std::vector<float>
windowedMeans(const std::vector<double>& values, const NoiseConstants& constants, int threads)
{
  constexpr std::size_t kTask = 128;
  std::vector<float> means(values.size(), 1.0f);
  parallelFor(values.size(), threads, kTask, [&](std::size_t s, int) {
    thread_local std::vector<double> window;
    const auto first = static_cast<std::ptrdiff_t>(s - std::min(s, constants.window));
    const auto end = static_cast<std::ptrdiff_t>(std::min(values.size(), s + constants.window + 1));
    window.assign(values.begin() + first, values.begin() + end);
    means[s] = static_cast<float>(trimmedMean(window, constants.trim));
  });
  return means;
}

namespace {

/** How many runs of points along the Morton curve a profile has an entry for. */
std::size_t
runsOf(const PointStore& store, const NoiseConstants& constants)
{
  return std::clamp(store.size() / constants.points_per_run,
                    std::min(constants.least_samples, store.size()), constants.most_runs);
}

/** The mean variance of patches of k points about every run. */
std::vector<float>
runVariances(const PointStore& store, std::size_t k, std::size_t runs,
             const NoiseConstants& constants, int threads, double* whole = nullptr)
{
  ThinnedPlaces places(store, runs);
  std::vector<double> variances =
      measureScale(places, k, constants, resolveThreads(threads)).variances;
  std::vector<float> means = windowedMeans(variances, constants, threads);
  if (whole != nullptr) *whole = trimmedMean(variances, constants.trim);
  return means;
}

}  // namespace

std::vector<float>
measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                    const NoiseConstants& constants, int threads)
{
  if (level.neighbors == 0) return {};
  const std::size_t runs = runsOf(store, constants);
  double whole;
  std::vector<float> profile =
      runVariances(store, level.neighbors, runs, constants, threads, &whole);
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
  const std::size_t runs = runsOf(store, constants);
  std::vector<float> profile = runVariances(store, k, runs, constants, threads);
  const std::vector<float> wider = runVariances(store, 2 * k, runs, constants, threads);
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
    thread_local Patch patch;
    patchAbout(store, search, sample, k / stride, patch);
    const Vector3 sensor = error.own_sensors ? store.sensor(sample) : error.sensor;
    const Vector3 ray = subtract(store.position(sample), sensor);
    const double z = length(ray), sigma = error.a + error.b * z + error.c * z * z;
    const Eigen::Vector3d normal = principalAxes(patch.points).eigenvectors().col(0);
    const double along = dot(ray, {normal[0], normal[1], normal[2]}) / std::max(z, 1e-300);
    return sigma * sigma * along * along;
  };
  const std::size_t runs = runsOf(store, constants);
  return windowedMeans(sampleStore(store, runs, stride, threads, variance), constants, threads);
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

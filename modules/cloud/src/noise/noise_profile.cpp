// SPDX-License-Identifier: BSD-3-Clause
// How noise varies along the Morton curve (docs/theory.md, "Noise").
#include <algorithm>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/cloud/noise_level.h"

namespace pcl_slim {

namespace detail {

namespace {

/** Trimmed means over windows about each of the values. */
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

}  // namespace

std::vector<float>
measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                    const NoiseConstants& constants, int threads)
{
  if (level.neighbors == 0) return {};
  const std::size_t k = level.neighbors;
  const std::size_t samples =
      std::clamp(store.size() / constants.points_per_run,
                 std::min(constants.least_samples, store.size()), constants.most_runs);
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    double radius;
    return patchVariance(store, search, sample, k, constants, radius);
  };
  auto values =
      sampleStore(store, samples, patchStride(k, constants), resolveThreads(threads), measure);
  std::vector<float> profile = windowedMeans(values, constants);
  const double whole = trimmedMean(values, constants.trim);
  const float least = constants.least_ratio;
  for (float& ratio : profile) {
    ratio = whole > 0 ? std::clamp(static_cast<float>(ratio / whole), least, 1 / least) : 1.0f;
  }
  return profile;
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

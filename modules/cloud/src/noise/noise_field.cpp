// SPDX-License-Identifier: BSD-3-Clause
// How noise varies along the Morton curve (docs/noise.md, "Field").
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/noise_level.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

std::size_t profileRuns(const PointStore& store, const NoiseConstants& constants) {
  constexpr std::size_t kPointsPerRun = 128, kMostRuns = 8192;
  return std::clamp(store.size() / kPointsPerRun, std::min(constants.least_samples, store.size()),
                    kMostRuns);
}

std::vector<float> measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                                       const NoiseConstants& constants, int threads) {
  if (level.neighbors == 0) return {};
  threads = resolveThreads(threads);
  ThinnedPlaces places(store, profileRuns(store, constants));
  std::vector<double> variances =
      measureScale(places, level.neighbors, constants, threads).variances;
  std::vector<float> profile = windowedMeans(variances, constants, threads);
  const double whole = trimmedMean(variances, constants.trim);
  const float least = constants.least_ratio;
  for (float& ratio : profile) {
    ratio = whole > 0 ? std::clamp(static_cast<float>(ratio / whole), least, 1 / least) : 1.0f;
  }
  return profile;
}

// The field of white noise: a normal prior for the logarithm of the ratio to the cloud's level,
// whose variance the places themselves give (empirical Bayes; Efron and Morris 1973).

namespace {

constexpr double kLeastRatio = 1e-6;            ///< least ratio of a local variance to the cloud's
constexpr double kVarianceOfMedian = M_PI / 2;  ///< over that of a mean of normal values
constexpr double kQuartileRange = 1.349;        ///< of a standard normal distribution
constexpr std::size_t kLeastValues = 4;         ///< a window with fewer values is unknown

/** The noise around a place. */
struct LocalNoise {
  double log = 0;     ///< logarithm of its variance over the cloud's
  double chance = 0;  ///< squared standard error of it; < 0: unknown
};

/** The median of the logarithms of the patches around every place. Patches across an edge of the
 * surface or on an object beside it are few, so that they hardly change a median.
 * \param[in] overlap number of patches that contain a point, at least 1: as many have one chance
 * error */
std::vector<LocalNoise> localNoise(const PatchScale& scale, double level, double overlap,
                                   const NoiseConstants& constants, int threads) {
  std::vector<double> variances = scale.variances;
  restoreCutVariances(scale.radii, constants, threads, variances);
  // The median of chi-square over its number of degrees of freedom (Wilson and Hilferty 1931).
  const std::size_t points = scale.k / scale.stride;
  const auto freedom = static_cast<double>(points - kCubicTerms);
  const double bias = 3 * std::log(1 - 2 / (9 * freedom)), least = std::log(kLeastRatio);
  std::vector<LocalNoise> noise(variances.size());
  std::vector<double> logs;
  for (std::size_t s = 0; s < variances.size(); ++s) {
    const auto [first, end] = windowAround(s, variances.size());
    logs.clear();
    for (std::size_t i = first; i < end; ++i) {
      if (variances[i] >= 0) logs.push_back(std::log(std::max(variances[i] / level, kLeastRatio)));
    }
    noise[s].chance = -1;
    if (logs.size() < kLeastValues) continue;
    std::sort(logs.begin(), logs.end());
    const std::size_t n = logs.size();
    const double spread = (logs[3 * n / 4] - logs[n / 4]) / kQuartileRange;
    // Points without noise are at the least ratio on patches of any size.
    noise[s].log = logs[n / 2] > least ? logs[n / 2] - bias : least;
    noise[s].chance = kVarianceOfMedian * spread * spread * overlap / static_cast<double>(n);
  }
  return noise;
}

/** How the noise of a cloud varies over places. */
struct NoiseField {
  std::vector<LocalNoise> places;
  double variance = 0;  ///< of the true logarithms about that of the cloud's level
  double error = 0;     ///< standard error of this variance where it is 0
};

/** Estimates the field from patches of k and of 2 k points at the same places. A place counts where
 * patches of both sizes have the same variance within two standard errors: that of detail and edges
 * depends on the size. */
NoiseField fieldOf(const PatchScale& scale, const PatchScale& wider, std::size_t points,
                   double level, const NoiseConstants& constants, int threads) {
  const double per_point = static_cast<double>(scale.variances.size() * scale.k);
  const double overlap = std::max(1.0, per_point / static_cast<double>(points));
  NoiseField field;
  field.places = localNoise(scale, level, overlap, constants, threads);
  const auto wide = localNoise(wider, level, overlap, constants, threads);
  const double most = -std::log(static_cast<double>(constants.least_ratio));
  double squares = 0, chances = 0, known = 0;
  for (std::size_t s = 0; s < field.places.size(); ++s) {
    LocalNoise& place = field.places[s];
    if (place.chance < 0) continue;
    const double growth = wide[s].log - place.log;
    const double chance = place.chance + std::max(0.0, wide[s].chance);
    const bool constant = wide[s].chance >= 0 && growth * growth <= 4 * chance;
    place.log = constant ? std::min(place.log, most) : 0;
    squares += place.log * place.log;
    chances += place.chance;
    ++known;
  }
  if (!(known > 0)) return field;
  field.variance = std::max(0.0, (squares - chances) / known);
  const auto [first, end] = windowAround(field.places.size() / 2, field.places.size());
  const double windows = known / static_cast<double>(end - first);
  field.error = chances / known * std::sqrt(2 / std::max(1.0, windows));
  return field;
}

/** Measures the field at evenly strided places. */
NoiseField measuredField(const PointStore& store, const NoiseLevel& level, std::size_t count,
                         const NoiseConstants& constants, int threads) {
  ThinnedPlaces places(store, count);
  const PatchScale scale = measureScale(places, level.neighbors, constants, threads);
  const PatchScale wider = measureScale(places, 2 * level.neighbors, constants, threads, &scale);
  return fieldOf(scale, wider, store.size(), level.variance, constants, threads);
}

}  // namespace

std::vector<float> measureNoiseField(const PointStore& store, const NoiseLevel& level, bool known,
                                     const NoiseConstants& constants, int threads) {
  if (level.neighbors == 0 || !(level.variance > 0)) return {};
  if (!known && isRoundingOfFloats(level.variance, store)) return {};
  threads = resolveThreads(threads);
  const std::size_t runs = profileRuns(store, constants);
  const std::size_t places = known ? runs : std::min(constants.shared.places, runs);
  NoiseField field = measuredField(store, level, places, constants, threads);
  if (!(field.variance > (known ? 0 : 2 * field.error))) return {};
  if (places < runs) field = measuredField(store, level, runs, constants, threads);
  std::vector<float> ratios(field.places.size(), 1.0f);
  for (std::size_t s = 0; s < ratios.size(); ++s) {
    const LocalNoise& place = field.places[s];
    if (place.chance < 0) continue;
    const double share = field.variance / (field.variance + place.chance);
    ratios[s] = static_cast<float>(std::exp(share * place.log));
  }
  return ratios;
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

std::vector<float> noiseProfile(const PointStore& store, int threads) {
  const detail::NoiseConstants constants;
  return detail::measureNoiseProfile(store, detail::measureNoise(store, constants, threads),
                                     constants, threads);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// What a cloud's noise is: white, shared by neighbours, of points on lines or of rounded coordinates
// (docs/noise.md).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "noise/noise_curve.h"
#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kRoundingPlaces = 1200;  ///< number of places where rounding is measured
/// Growth beyond the patches that show all of the rounding at which the chance of noise is 1/e.
constexpr double kRoundingGrowth = 0.7;

/** Measures the noise of a rounded coordinate. Its errors change sign from one terrace to the next
 * and cancel in wide cells. Where detail follows directly, patches of half the width are used.
 * \param[in] k number of points of patches that show all of it
 * \param[out] scales the scales measured: k / 2, k and 2 k */
CurveNoise measureRounding(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                           int threads, std::vector<PatchScale>& scales) {
  ThinnedPlaces points(store, kRoundingPlaces);
  for (const std::size_t size : {k / 2, k, 2 * k})
    scales.push_back(measureScale(points, size, constants, threads));
  const double narrow = levelOf(scales[0], constants), wide = levelOf(scales[1], constants);
  const double growth = std::log2(median(scales[2].variances) / median(scales[1].variances));
  const double chance = fallOff(growth, kRoundingGrowth);
  const double least = constants.shared.full_correlation;
  const double shared = std::max(least, correlationOf(scales[2], constants));
  return {narrow * std::pow(wide / narrow, chance), least * std::pow(shared / least, chance), 1};
}

/// Largest correlation that a fit counts in full [points]. Of a larger one the geometric mean with
/// this counts: a large tau rounds edges, and the reduction costs smooth parts little.
constexpr double kFullDependence = 12;

/** Sets the correlation of the noise, and the number of points that a fit counts as one. */
void setCorrelation(double correlation, NoiseLevel& noise) {
  noise.correlation = noise.dependence = correlation;
  if (correlation > kFullDependence) noise.dependence = std::sqrt(kFullDependence * correlation);
}

/** The noise of one scale. */
NoiseLevel scaleNoise(const PatchScale& scale, const NoiseConstants& constants) {
  NoiseLevel noise;
  noise.variance = levelOf(scale, constants);
  noise.error = 0.5 * trimmedMeanError(scale.variances, constants.trim);
  noise.patch_radius = median(scale.radii);
  noise.neighbors = scale.k;
  return noise;
}

/** Sets the errors of a curve's noise. Its variance has three: the scatter of the estimates from
 * halves, the chance error of a variance of n / tau values, and the error of white noise. */
void setErrors(const NoiseCurve& curve, const CurveShare& all, const NoiseLevel& white,
               double points, const SharedNoiseConstants& constants, NoiseLevel& noise) {
  const LogErrors errors = errorsOf(curve, white.variance, constants);
  const double chance = all.part * 2 * all.correlation / points;
  noise.error = std::hypot(0.5 * std::sqrt(errors.variance + chance), (1 - all.part) * white.error);
  noise.correlation_error = std::sqrt(errors.correlation + chance);
}

/** The noise of a curve that counts, or white noise. */
NoiseLevel curveNoise(const NoiseCurve& curve, const NoiseLevel& white, double points,
                      const NoiseConstants& constants) {
  const SharedNoiseConstants& shared = constants.shared;
  const CurveShare share = shareOf(curve.noise, white.variance, shared);
  NoiseLevel noise = share.correlation > shared.white_correlation
                         ? scaleNoise(curve.scales[curve.noise.scale], constants)
                         : white;
  noise.variance = share.variance;
  if (share.correlation > shared.white_correlation) setCorrelation(share.correlation, noise);
  setErrors(curve, share, white, points, shared, noise);
  return noise;
}

/** The noise of a rounded coordinate with little other noise. */
NoiseLevel roundingNoise(const PointStore& store, const StepNoise& steps,
                         const NoiseConstants& constants, int threads) {
  std::vector<PatchScale> scales;
  const CurveNoise rounding = measureRounding(store, steps.neighbors, constants, threads, scales);
  NoiseLevel noise = scaleNoise(scales[rounding.scale], constants);
  noise.variance = rounding.variance;
  setCorrelation(rounding.correlation, noise);
  return noise;
}

/** White noise of points on lines. Across a line, its points count as one independent point. */
NoiseLevel lineNoise(const NoiseLevel& white) {
  NoiseLevel noise = white;
  noise.dependence = static_cast<double>(white.line);
  return noise;
}

}  // namespace

NoiseLevel recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                                const NoiseConstants& constants, int threads) {
  if (white.neighbors == 0) return white;
  if (white.line > 0) return lineNoise(white);
  threads = resolveThreads(threads);
  const NoiseCurve curve = measureCurve(store, white.neighbors, white.variance, constants, threads);
  const std::vector<PatchScale>& scales = curve.scales;
  if (isRoundingOfFloats(curve.noise.variance, store)) return white;
  NoiseLevel noise = curveNoise(curve, white, static_cast<double>(store.size()), constants);
  const StepNoise steps = measureSteps(store, constants, threads);
  if (steps.step > 0 && store.size() >= 2 * constants.most_part * steps.neighbors) {
    const NoiseLevel rounding = roundingNoise(store, steps, constants, threads);
    if (noise.correlation < constants.shared.full_correlation ||
        !isFlat(noise.variance, rounding.variance, constants))
      noise = rounding;
    noise.step = steps.step;
  }
  noise.patches = white.patches + scales.size() * scales.front().variances.size();
  return noise;
}

NoiseLevel measureSharedNoise(const PointStore& store, double correlation,
                              const NoiseConstants& constants, int threads) {
  threads = resolveThreads(threads);
  std::size_t k = smallestPatch(store, constants, threads);
  const std::size_t most = std::max<std::size_t>(k, store.size() / constants.most_part);
  while (static_cast<double>(k) < static_cast<double>(constants.shared.cells) * correlation &&
         2 * k <= most)
    k *= 2;
  NoiseLevel noise = scaleNoise(measureScale(store, k, constants, threads), constants);
  noise.correlation = noise.dependence = correlation;
  noise.patches = constants.shared.places;
  return noise;
}

}  // namespace pcl_slim::detail

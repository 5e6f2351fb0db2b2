// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": what a cloud's noise is, from the curve of its scales.
#include <algorithm>
#include <cmath>

#include "noise/noise_curve.h"
#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

/** Whether a share of places has more noise than the cloud by a factor that a fit takes for detail. */
bool
isUneven(const PatchScale& scale, const PatchScale& wider, double variance,
         const NoiseConstants& constants, int threads)
{
  const auto narrow = windowedMeans(scale.variances, constants, threads);
  const auto wide = windowedMeans(wider.variances, constants, threads);
  std::size_t noisy = 0;
  for (std::size_t s = 0; s < wide.size(); ++s)
    noisy += wide[s] > constants.uneven * variance && isFlat(narrow[s], wide[s], constants);
  return static_cast<double>(noisy) > constants.uneven_share * static_cast<double>(wide.size());
}

/** The same on two pairs of scales: an edge's residual is noise to one of them at most.
 * \param[in] scales the first two of a curve, from the noise's own patches on or not; all are measured at their
 * places */
bool
staysUneven(const PointStore& store, const NoiseLevel& noise, const std::vector<PatchScale>& scales,
            const NoiseConstants& constants, int threads)
{
  const std::size_t k = noise.neighbors;
  if (8 * k * constants.most_part > store.size()) return false;
  ThinnedPlaces points(store, scales.front().variances.size());
  const auto scale = [&](std::size_t factor) {
    return measureScale(points, factor * k, constants, threads);
  };
  const bool known = scales.front().k == k;
  const PatchScale narrow = known ? scales[0] : scale(1), wider = known ? scales[1] : scale(2);
  return isUneven(narrow, wider, noise.variance, constants, threads) &&
         isUneven(wider, scale(4), noise.variance, constants, threads);
}

/** Sets how many points share their errors, and as how many of these a fit counts one. */
void
setCorrelation(double correlation, const SharedNoiseConstants& constants, NoiseLevel& noise)
{
  noise.correlation = noise.dependence = correlation;
  if (correlation > constants.counted)
    noise.dependence = std::sqrt(constants.counted * correlation);
}

/** The noise that one scale shows. */
NoiseLevel
scaleNoise(const PatchScale& scale, const NoiseConstants& constants)
{
  NoiseLevel noise;
  noise.variance = levelOf(scale, constants);
  noise.error = 0.5 * trimmedMeanError(scale.variances, constants.trim);
  noise.patch_radius = median(scale.radii);
  noise.neighbors = scale.k;
  return noise;
}

/** Sets the errors of a curve's noise: the scatter of its halves, that of a variance of as many values as the
 * cloud has independent errors, and white noise's own. */
void
setErrors(const NoiseCurve& curve, const CurveShare& all, const NoiseLevel& white, double points,
          const SharedNoiseConstants& constants, NoiseLevel& noise)
{
  const LogErrors errors = errorsOf(curve, white.variance, constants);
  const double chance = all.part * 2 * all.correlation / points;
  noise.error = std::hypot(0.5 * std::sqrt(errors.variance + chance), (1 - all.part) * white.error);
  noise.correlation_error = std::sqrt(errors.correlation + chance);
}

/** The noise of a curve. */
NoiseLevel
curveNoise(const NoiseCurve& curve, const NoiseLevel& white, double points,
           const NoiseConstants& constants)
{
  const SharedNoiseConstants& shared = constants.shared;
  const CurveShare share = shareOf(curve.noise, white.variance, shared);
  NoiseLevel noise = share.correlation > shared.white
                         ? scaleNoise(curve.scales[curve.noise.scale], constants)
                         : white;
  noise.variance = share.variance;
  if (share.correlation > shared.white) setCorrelation(share.correlation, shared, noise);
  setErrors(curve, share, white, points, shared, noise);
  return noise;
}

/** Rounding of a coordinate where there is little other noise. */
NoiseLevel
roundingNoise(const PointStore& store, const StepNoise& steps, const NoiseConstants& constants,
              int threads)
{
  std::vector<PatchScale> scales;
  const CurveNoise rounding = measureRounding(store, steps.neighbors, constants, threads, scales);
  NoiseLevel noise = scaleNoise(scales[rounding.scale], constants);
  noise.variance = rounding.variance;
  setCorrelation(rounding.correlation, constants.shared, noise);
  noise.step = steps.step;
  return noise;
}

/** White noise of points on lines: across a line its points count as one independent point. */
NoiseLevel
alongLines(const NoiseLevel& white)
{
  NoiseLevel noise = white;
  noise.dependence = static_cast<double>(white.line);
  return noise;
}

}  // namespace

NoiseLevel
recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                     const NoiseConstants& constants, int threads)
{
  if (white.neighbors == 0) return white;
  if (white.line > 0) return alongLines(white);
  threads = resolveThreads(threads);
  const NoiseCurve curve = measureCurve(store, white.neighbors, white.variance, constants, threads);
  const std::vector<PatchScale>& scales = curve.scales;
  const double resolved = constants.shared.resolved * store.bulkDiagonal();
  if (curve.noise.variance < resolved * resolved) return white;
  NoiseLevel noise = curveNoise(curve, white, static_cast<double>(store.size()), constants);
  const StepNoise steps = measureSteps(store, constants, threads);
  if (steps.step > 0 && store.size() >= 2 * constants.most_part * steps.neighbors) {
    const NoiseLevel rounding = roundingNoise(store, steps, constants, threads);
    if (noise.correlation < constants.shared.all ||
        !isFlat(noise.variance, rounding.variance, constants))
      noise = rounding;
  }
  if (!(noise.correlation > 1))
    noise.uneven = staysUneven(store, noise, scales, constants, threads);
  noise.patches = white.patches + scales.size() * scales.front().variances.size();
  return noise;
}

NoiseLevel
measureSharedNoise(const PointStore& store, double correlation, const NoiseConstants& constants,
                   int threads)
{
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

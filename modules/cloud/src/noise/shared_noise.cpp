// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": the curve of residual variance over scales.
#include <algorithm>
#include <cmath>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"

namespace pcl_slim::detail {

namespace {

/** Residual variances of patches of k points, place by place. */
struct Scale {
  std::size_t k = 0;
  std::vector<double> variances, radii;
};

Scale
measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads)
{
  Scale scale;
  scale.k = k;
  scale.radii.resize(std::min(constants.shared.places, store.size()));
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
    return patchVariance(store, search, sample, k, constants, scale.radii[s]);
  };
  scale.variances =
      sampleStore(store, scale.radii.size(), patchStride(k, constants), threads, measure);
  return scale;
}

double
median(std::vector<double>& values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/** The median over places of log2 (wider / narrow); a share takes variances of 0. */
double
growth(const Scale& narrow, const Scale& wider)
{
  std::vector<double> shares;
  for (std::size_t s = 0; s < narrow.variances.size(); ++s) {
    const double a = narrow.variances[s], b = wider.variances[s];
    if (a < 0 || b < 0) continue;
    shares.push_back(a + b > 0 ? b / (a + b) : 0.5);
  }
  if (shares.empty()) return 0;
  const double share = median(shares);
  return share < 1 ? std::log2(share / (1 - share)) : HUGE_VAL;
}

/** Follows the curve from scale to scale until it says what the noise is. */
class GrowthCurve {
 public:
  explicit GrowthCurve(const SharedNoiseConstants& constants) : constants_(constants) {}

  /** Takes in the growth from the next scale on. \return whether the curve is told to its end. */
  bool follow(double growth)
  {
    const std::size_t scale = scales_++;
    if (scale == 0) {
      first_ = least_ = growth;
      return growth <= constants_.white;
    }
    const bool detail = growth > least_ + constants_.rise || growth > constants_.steep;
    if (growth < least_) {
      least_ = growth;
      slowest_ = scale;
    }
    return detail || growth <= constants_.plateau;
  }

  /** The number of the scale of least growth, if the curve has slowed down enough there; else 0. */
  std::size_t plateau() const
  {
    if (first_ <= constants_.white) return 0;
    const bool slow = least_ <= constants_.slow && least_ <= first_ - constants_.fall;
    return slow || least_ <= constants_.plateau ? slowest_ : 0;
  }

 private:
  const SharedNoiseConstants& constants_;
  std::size_t scales_ = 0, slowest_ = 0;
  double first_ = 0, least_ = 0;
};

/** Measures scales until their curve ends. \return the number of its plateau, 0 where it has none. */
std::size_t
measureCurve(const PointStore& store, std::size_t least, const NoiseConstants& constants,
             int threads, std::vector<Scale>& scales)
{
  const std::size_t most = store.size() / constants.shared.most_part;
  GrowthCurve curve(constants.shared);
  scales.push_back(measureScale(store, least, constants, threads));
  for (std::size_t k = 2 * least; k <= most; k *= 2) {
    scales.push_back(measureScale(store, k, constants, threads));
    if (curve.follow(growth(scales[scales.size() - 2], scales.back()))) break;
  }
  return curve.plateau();
}

/** Whether some places have so much more noise than the cloud that it would pass for lack of fit. */
bool
isUneven(const Scale& scale, const Scale& wider, double variance, const NoiseConstants& constants)
{
  const auto narrow = windowedMeans(scale.variances, constants);
  const auto wide = windowedMeans(wider.variances, constants);
  std::size_t noisy = 0;
  for (std::size_t s = 0; s < wide.size(); ++s)
    noisy += wide[s] > constants.uneven * variance && isFlat(narrow[s], wide[s], constants.shared);
  return static_cast<double>(noisy) > constants.uneven_share * static_cast<double>(wide.size());
}

/** The noise level of a scale; white's own where the scale is none. */
NoiseLevel
levelOf(const Scale& scale, const NoiseConstants& constants)
{
  NoiseLevel noise;
  std::vector<double> variances = scale.variances, radii = scale.radii;
  const double variance = trimmedMean(variances, constants.trim);
  noise.patch_radius = median(radii);
  noise.variance = variance * (1 + 2 * variance / (noise.patch_radius * noise.patch_radius));
  noise.neighbors = scale.k;
  return noise;
}

/** Steps of a coordinate that the curve does not show, since noise hides where they lie. */
NoiseLevel
withSteps(const PointStore& store, const NoiseLevel& white, const NoiseConstants& constants,
          int threads)
{
  const double step = measureSteps(store, constants, threads);
  const std::size_t k = constants.steps.wide;
  if (!(step > 0) || store.size() < constants.shared.most_part * k) return white;
  NoiseLevel noise = levelOf(measureScale(store, k, constants, threads), constants);
  noise.correlation =
      std::max(constants.steps.correlation, measureCorrelation(store, k, constants, threads));
  noise.step = step;
  return noise;
}

}  // namespace

NoiseLevel
recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                     const NoiseConstants& constants, int threads)
{
  if (white.neighbors == 0) return white;
  threads = resolveThreads(threads);
  std::vector<Scale> scales;
  const std::size_t plateau =
      measureCurve(store, white.least_neighbors, constants, threads, scales);
  NoiseLevel noise = white;
  if (plateau > 0) {
    noise = levelOf(scales[plateau], constants);
    const double tau = measureCorrelation(store, noise.neighbors, constants, threads);
    if (tau >= constants.shared.least) noise.correlation = tau;
  }
  if (!(noise.correlation > 1)) noise = withSteps(store, noise, constants, threads);
  if (!(noise.correlation > 1) && plateau + 1 < scales.size())
    noise.uneven = isUneven(scales[plateau], scales[plateau + 1], noise.variance, constants);
  noise.patches = white.patches + scales.size() * scales.front().variances.size();
  return noise;
}

NoiseLevel
measureSharedNoise(const PointStore& store, double correlation, const NoiseConstants& constants,
                   int threads)
{
  const std::size_t most =
      std::max<std::size_t>(constants.first_neighbors, store.size() / constants.shared.most_part);
  std::size_t k = constants.first_neighbors;
  while (static_cast<double>(k) < constants.shared.given_patch * correlation && 2 * k <= most)
    k *= 2;
  threads = resolveThreads(threads);
  NoiseLevel noise = levelOf(measureScale(store, k, constants, threads), constants);
  noise.correlation = correlation;
  noise.patches = constants.shared.places;
  return noise;
}

}  // namespace pcl_slim::detail

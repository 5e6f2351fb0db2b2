// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": the curve of residual variance over scales.
#include <algorithm>
#include <cmath>
#include <optional>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"

namespace pcl_slim::detail {

namespace {

/** Residual variances of patches of k points, place by place. */
struct Scale {
  std::size_t k = 0;
  std::vector<double> variances, radii;

  /** The variance at the place that is the s-th of so many. */
  double at(std::size_t s, std::size_t places) const
  {
    return variances[(2 * s + 1) * variances.size() / (2 * places)];
  }
};

Scale
measureScale(const PointStore& store, std::size_t k, std::size_t places,
             const NoiseConstants& constants, int threads)
{
  Scale scale;
  scale.k = k;
  scale.radii.resize(std::min(places, store.size()));
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

/** The median over the wider scale's places of log2 (wider / narrow); a share takes variances of 0. */
double
growth(const Scale& narrow, const Scale& wider)
{
  std::vector<double> shares;
  const std::size_t places = wider.variances.size();
  for (std::size_t s = 0; s < places; ++s) {
    const double a = narrow.at(s, places), b = wider.variances[s];
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
  /** The curve from the smallest patches on: white noise shows at once. */
  explicit GrowthCurve(const SharedNoiseConstants& constants)
      : constants_(constants), flat_first_(constants.white), steep_first_(HUGE_VAL)
  {
  }

  /** The curve from patches on that are wide enough for detail to show at once. */
  static GrowthCurve ofWidePatches(const SharedNoiseConstants& constants)
  {
    GrowthCurve curve(constants);
    curve.flat_first_ = constants.plateau;
    curve.steep_first_ = constants.slow;
    return curve;
  }

  /** Takes in the growth from the next scale on. \return whether the curve is told to its end. */
  bool follow(double growth)
  {
    const bool first = growths_.empty();
    const double steep =
        first ? steep_first_ : std::min(least() + constants_.rise, constants_.steep);
    growths_.push_back(growth);
    detail_ = growth > steep;
    return detail_ || growth <= (first ? flat_first_ : constants_.plateau);
  }

  /** Whether growth has slowed down as shared noise makes it. */
  bool slowsDown() const
  {
    if (growths_.empty() || growths_.front() <= flat_first_) return false;
    const auto least_at = std::min_element(growths_.begin(), growths_.end());
    const double peak = *std::max_element(growths_.begin(), least_at + 1);
    return *least_at <= constants_.plateau ||
           (*least_at <= constants_.slow && *least_at <= constants_.fall * peak);
  }

  bool startsInDetail() const { return detail_ && growths_.size() == 1; }

  /** A scale that shows all of the noise, and whether wider ones show detail. */
  struct Plateau {
    std::size_t scale = 0;
    bool detail_follows = false;
  };

  /** The widest scale whose growth is about the least; where growth has passed a peak since, and no
   * detail follows, the last one. */
  Plateau slowest() const
  {
    const auto least_at = std::min_element(growths_.begin(), growths_.end());
    const double peak = *std::max_element(least_at, growths_.end());
    if (!detail_ && growths_.back() < peak) return {growths_.size() - 1, false};
    std::size_t scale = growths_.size();
    while (scale > 1 && growths_[scale - 1] > constants_.slack * least()) --scale;
    return {scale - 1, detail_};
  }

  /** The scale where growth was least before its last peak, if it had slowed down there: what
   * follows is detail that wider patches have left behind. */
  std::optional<Plateau> beforeLastPeak() const
  {
    auto peak = growths_.end() - 1;
    while (peak > growths_.begin() && *(peak - 1) >= *peak) --peak;
    const auto dip = std::min_element(growths_.begin(), peak);
    const double limit = std::min(constants_.slow, constants_.fall * growths_.front());
    if (dip == peak || *dip > limit) return {};
    return Plateau{static_cast<std::size_t>(dip - growths_.begin()), true};
  }

 private:
  double least() const { return *std::min_element(growths_.begin(), growths_.end()); }

  const SharedNoiseConstants& constants_;
  double flat_first_, steep_first_;  ///< growth at the first scale that tells all
  std::vector<double> growths_;
  bool detail_ = false;
};

/** Measures scales from k points on until their curve ends. */
void
measureCurve(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads,
             GrowthCurve& curve, std::vector<Scale>& scales)
{
  const std::size_t most = store.size() / constants.shared.most_part;
  for (; scales.empty() || k <= most; k *= 2) {
    scales.push_back(measureScale(store, k, constants.shared.places, constants, threads));
    if (scales.size() < 2) continue;
    if (curve.follow(growth(scales[scales.size() - 2], scales.back()))) break;
  }
}

/** Whether a share of places has more noise than the cloud by a factor that a fit takes for detail. */
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

/** The same on two pairs of scales: an edge's residual is noise to one of them at most.
 * \param[in] scales the first two of a curve, from the noise's own patches on or not */
bool
staysUneven(const PointStore& store, const NoiseLevel& noise, const std::vector<Scale>& scales,
            const NoiseConstants& constants, int threads)
{
  const std::size_t k = noise.neighbors;
  if (4 * k * constants.shared.most_part > store.size()) return false;
  const auto scale = [&](std::size_t factor) {
    return measureScale(store, factor * k, constants.shared.places, constants, threads);
  };
  const bool known = scales.front().k == k;
  const Scale narrow = known ? scales[0] : scale(1), wider = known ? scales[1] : scale(2);
  return isUneven(narrow, wider, noise.variance, constants) &&
         isUneven(wider, scale(4), noise.variance, constants);
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

/** The binary logarithm of the factor by which the trimmed mean grows. */
double
meanGrowth(const Scale& narrow, const Scale& wider, const NoiseConstants& constants)
{
  std::vector<double> a = narrow.variances, b = wider.variances;
  return std::log2(trimmedMean(b, constants.trim) / trimmedMean(a, constants.trim));
}

/** The widest scale, up to the given one, whose trimmed mean has grown as its median has: beyond it,
 * creases lie in more places than the mean leaves out. The first never shows all of shared noise. */
std::size_t
beforeCreases(const std::vector<Scale>& scales, std::size_t scale, const NoiseConstants& constants)
{
  const auto creased = [&](const Scale& narrow, const Scale& wider) {
    return meanGrowth(narrow, wider, constants) > growth(narrow, wider) + constants.shared.creases;
  };
  while (scale > 1 && creased(scales[scale - 1], scales[scale])) --scale;
  return scale;
}

/** How many points share what a scale shows; 1 where they share no noise. \param[in] waves whether
 * it may be waves of the surface */
double
correlationOf(const PointStore& store, bool detail_follows, bool waves, const NoiseLevel& noise,
              const NoiseConstants& constants, int threads)
{
  // Where the surface's detail shows in wider patches already, tau is measured without them.
  const std::size_t points = (detail_follows ? 1 : 2) * noise.neighbors;
  if (!waves) return measureCorrelation(store, points, constants, threads);
  // Waves that the smallest patches do not resolve share over half a wave, and nothing over two.
  const std::size_t wider = 4 * points;
  if (wider > store.size() / 4) return 1;
  const double tau = measureCorrelation(store, points, constants, threads);
  if (tau < constants.shared.least) return 1;
  return measureCorrelation(store, wider, constants, threads) > 0.5 * tau ? tau : 1;
}

/** The noise of a curve's plateau with the points that share it: 1 where it is none. */
NoiseLevel
plateauNoise(const PointStore& store, const GrowthCurve::Plateau& plateau, bool waves,
             const std::vector<Scale>& scales, const NoiseConstants& constants, int threads)
{
  const std::size_t scale = beforeCreases(scales, plateau.scale, constants);
  NoiseLevel noise = levelOf(scales[scale], constants);
  noise.correlation =
      correlationOf(store, plateau.detail_follows, waves, noise, constants, threads);
  noise.dependence = noise.correlation;
  if (!plateau.detail_follows && noise.correlation > constants.shared.counted)
    noise.dependence = std::sqrt(constants.shared.counted * noise.correlation);
  return noise;
}

/** Steps of a coordinate that the curve does not show, since noise hides where they lie. */
NoiseLevel
withSteps(const PointStore& store, const NoiseLevel& white, const NoiseConstants& constants,
          int threads)
{
  const StepNoise steps = measureSteps(store, constants, threads);
  const std::size_t k = steps.neighbors;
  if (!(steps.step > 0) || store.size() < 2 * constants.shared.most_part * k) return white;
  std::vector<Scale> scales;
  GrowthCurve curve = GrowthCurve::ofWidePatches(constants.shared);
  measureCurve(store, k, constants, threads, curve, scales);
  NoiseLevel noise = plateauNoise(store, curve.slowest(), !steps.pure, scales, constants, threads);
  if (!(noise.correlation > 1) || curve.startsInDetail()) {
    const std::size_t narrow = curve.startsInDetail() ? k / 2 : k;
    noise = levelOf(measureScale(store, narrow, constants.shared.places, constants, threads),
                    constants);
  }
  noise.correlation = std::max(noise.correlation, constants.steps.correlation);
  noise.dependence = std::max(noise.dependence, constants.steps.correlation);
  noise.step = steps.step;
  return noise;
}

/** Noise that is white but differs from place to place, told on patches that show all of it. */
NoiseLevel
withUnevenness(const PointStore& store, const NoiseLevel& white, const NoiseLevel& plateau,
               const std::vector<Scale>& scales, const NoiseConstants& constants, int threads)
{
  NoiseLevel noise = plateau;
  noise.correlation = noise.dependence = 1;
  noise.uneven = staysUneven(store, noise, scales, constants, threads);
  return noise.uneven ? noise : white;
}

/** White noise of points on lines: those of a line say of the surface across it what one says. */
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
  std::vector<Scale> scales;
  GrowthCurve curve(constants.shared);
  measureCurve(store, white.least_neighbors, constants, threads, curve, scales);
  NoiseLevel noise = white;
  if (curve.slowsDown()) {
    noise = plateauNoise(store, curve.slowest(), true, scales, constants, threads);
    const auto dip = curve.beforeLastPeak();
    if (!(noise.correlation > 1) && dip)
      noise = plateauNoise(store, *dip, true, scales, constants, threads);
  }
  // Between steps as few share an error as chance would have it, and narrow patches see no more.
  const NoiseLevel stepped = withSteps(store, white, constants, threads);
  const bool more = noise.correlation < constants.steps.correlation ||
                    !isFlat(noise.variance, stepped.variance, constants.shared);
  if (stepped.step > 0 && more)
    noise = stepped;
  else if (!(noise.correlation > 1))
    noise = withUnevenness(store, white, noise, scales, constants, threads);
  noise.patches = white.patches + scales.size() * scales.front().variances.size();
  return noise;
}

NoiseLevel
measureSharedNoise(const PointStore& store, double correlation, const NoiseConstants& constants,
                   int threads)
{
  threads = resolveThreads(threads);
  std::size_t k = smallestPatch(store, constants, threads);
  const std::size_t most = std::max<std::size_t>(k, store.size() / constants.shared.most_part);
  while (static_cast<double>(k) < constants.shared.given_patch * correlation && 2 * k <= most)
    k *= 2;
  NoiseLevel noise =
      levelOf(measureScale(store, k, constants.shared.places, constants, threads), constants);
  noise.correlation = noise.dependence = correlation;
  noise.patches = constants.shared.places;
  return noise;
}

}  // namespace pcl_slim::detail

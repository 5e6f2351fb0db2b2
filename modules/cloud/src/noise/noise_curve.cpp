// SPDX-License-Identifier: BSD-3-Clause
// Noise that neighbours share (docs/theory.md, section of this name). The curve of the residual
// variance of cubics over the size of the patch separates it from detail.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

/** Noise as estimated from a curve. */
struct CurveNoise {
  double variance = 0, correlation = 1;
  std::size_t scale = 0;  ///< index of the first scale that shows most of it
};

/** The scales of a cloud, and the noise estimated from them. */
struct NoiseCurve {
  std::vector<PatchScale> scales;  ///< two at least
  CurveNoise noise;
  std::vector<CurveNoise> halves;  ///< estimates from random halves of the places
};

/** The part of a curve's noise that counts. Chance explains the rest. */
struct CurveShare {
  double part = 0;                       ///< part of log(variance / white variance) that counts
  double variance = 0, correlation = 1;  ///< figures of the noise that counts
};

/** Squared errors of the logarithms of the figures that count. */
struct LogErrors {
  double variance = 0, correlation = 0;
};

/** The kernel q of (N1): falls smoothly from 1 at 0 to 0 beyond a width. */
double fallOff(double x, double width) {
  const double ratio = std::max(0.0, x) / width;
  return std::exp(-ratio * ratio * ratio * ratio);
}

/// Share of the places at which growth is measured: those of the least variance.
constexpr double kGrowthPlaces = 0.35;
/// Number of scales that a comparison looks ahead. Growth is measured at the places of the least
/// variance on the scale this many doublings wider.
constexpr std::size_t kScalesAhead = 3;

/** The places measured on all three scales, of which the given share with the least variance on the
 * widest scale is returned. */
std::vector<std::size_t> leastVariancePlaces(const PatchScale& narrow, const PatchScale& wider,
                                             const PatchScale& widest, double share) {
  std::vector<std::size_t> places;
  for (std::size_t s = 0; s < widest.variances.size(); ++s) {
    if (std::min({narrow.variances[s], wider.variances[s], widest.variances[s]}) >= 0)
      places.push_back(s);
  }
  const std::vector<double>& variances = widest.variances;
  std::sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
    return variances[a] != variances[b] ? variances[a] < variances[b] : a < b;
  });
  const double count = share * static_cast<double>(places.size());
  places.resize(std::min(places.size(), static_cast<std::size_t>(std::ceil(count))));
  return places;
}

/** Binary logarithm of the ratio of two trimmed means. Exact planes have means of 0; the result is
 * clamped so that it is finite there, too. */
double growthOf(std::vector<double> narrow, std::vector<double> wider, double trim) {
  constexpr double kMostGrowth = 100;
  const double a = trimmedMean(narrow, trim), b = trimmedMean(wider, trim);
  if (!(a > 0) || !(b > 0)) return b > a ? kMostGrowth : a > b ? -kMostGrowth : 0;
  return std::clamp(std::log2(b / a), -kMostGrowth, kMostGrowth);
}

/** Figures of a scale, and their growth to the next scale. */
struct ScaleFigures {
  double variance = 0, correlation = 1;
  double growth = 0, power_growth = 0;
};

/** Measures growth at the places of the least variance on a wider scale, because a choice by the
 * compared scales themselves would bias their ratio. */
void measureGrowth(const std::vector<PatchScale>& scales, std::size_t i,
                   const SharedNoiseConstants& constants, ScaleFigures& figures) {
  const PatchScale &narrow = scales[i], &wider = scales[i + 1];
  const PatchScale& widest = scales[std::min(i + kScalesAhead, scales.size() - 1)];
  std::vector<double> variances[2], powers[2];
  for (const std::size_t s : leastVariancePlaces(narrow, wider, widest, kGrowthPlaces)) {
    variances[0].push_back(narrow.variances[s]);
    variances[1].push_back(wider.variances[s]);
    powers[0].push_back(narrow.power(s));
    powers[1].push_back(wider.power(s));
  }
  figures.growth = growthOf(variances[0], variances[1], constants.trim);
  figures.power_growth = growthOf(powers[0], powers[1], constants.trim);
}

constexpr double kFlatPlaceGrowth = 0.5;  ///< largest growth of the variance at a flat place

/** Measures level and correlation at the places where the variance grows little: the surface
 * is flat there at this scale. */
void measureFlatPlaces(const PatchScale& scale, const PatchScale& wider,
                       const NoiseConstants& constants, ScaleFigures& figures) {
  const SharedNoiseConstants& shared = constants.shared;
  PatchScale flat;
  flat.k = scale.k;
  flat.stride = scale.stride;
  for (std::size_t s = 0; s < scale.variances.size(); ++s) {
    if (scale.variances[s] < 0 || wider.variances[s] < 0) continue;
    if (wider.variances[s] > std::exp2(kFlatPlaceGrowth) * scale.variances[s]) continue;
    flat.variances.push_back(scale.variances[s]);
    flat.shared.push_back(scale.shared[s]);
    flat.radii.push_back(scale.radii[s]);
  }
  if (flat.variances.empty()) return;
  figures.variance = levelOf(flat, constants);
  if (scale.k >= 2 * shared.cells) figures.correlation = correlationOf(flat, constants);
}

/** Fall of the power as a binary logarithm: the larger of that from the narrower scales to scale i
 * and that from scale i, or one of the next, to a later one of these. */
double powerFall(const std::vector<ScaleFigures>& figures, std::size_t i) {
  double power = 0, greatest = 0, fall = 0;
  for (std::size_t j = 0; j < std::min(i + kScalesAhead, figures.size()); ++j) {
    if (j == i) fall = greatest - power;
    if (j == i) greatest = power;
    power += figures[j].power_growth;
    greatest = std::max(greatest, power);
    if (j >= i) fall = std::max(fall, greatest - power);
  }
  return fall;
}

// Constants of (N1).
constexpr double kPlateauGrowth = 0.33;  ///< growth at which the chance of a plateau is 1/e
/// The same as a share of the greatest growth before. The larger one of the two is used.
constexpr double kPlateauGrowthRatio = 0.62;
/// Bound of the greatest growth before.
constexpr double kMostPeakGrowth = 0.8;
constexpr double kShapeGrowth = 1.2;  ///< growth at which the chance that it is a shape's is 1/2
constexpr double kShapeGrowthWidth = 0.1;  ///< width of the transition around kShapeGrowth
constexpr double kPowerFall = 0.8;  ///< fall of the power at which the chance of noise is 1/e

/** Chances that a scale is a plateau of noise. */
struct PlateauChance {
  double slow = 0;  ///< its variance grows more slowly than before, or hardly at all
  double flat = 0;  ///< its variance hardly grows at all
};

/** Evaluates (N1). */
std::vector<PlateauChance> plateauChances(const std::vector<ScaleFigures>& figures) {
  std::vector<PlateauChance> chances;
  double no_shape = 1;  // chance that no growth so far was a shape's
  double peak = 0;      // greatest growth so far
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const ScaleFigures& f = figures[i];
    const double constant_power = fallOff(std::abs(f.power_growth), kPlateauGrowth);
    const double noise =
        std::max(no_shape, constant_power) * fallOff(powerFall(figures, i), kPowerFall);
    const double slow = kPlateauGrowthRatio * std::min(peak, kMostPeakGrowth);
    chances.push_back({noise * fallOff(f.growth, std::max(kPlateauGrowth, slow)),
                       noise * fallOff(f.growth, kPlateauGrowth)});
    peak = std::max(peak, f.growth);
    no_shape /= 1 + std::exp((f.growth - kShapeGrowth) / kShapeGrowthWidth);
  }
  return chances;
}

// Largest growth of the figures after a plateau: a multiple of the growth at the places of least
// variance, plus a constant. More growth is shape.
constexpr double kGrowthRatioAfterPlateau = 1.5;
constexpr double kGrowthAfterPlateau = 0.1;

/** Logarithms of the variance and the correlation of every scale, without growth after a plateau
 * that is shape.
 * \param[in] white variance of the smallest patches, for scales without a flat place */
std::vector<Eigen::Array2d> withoutShape(const std::vector<ScaleFigures>& figures,
                                         const std::vector<PlateauChance>& chances, double white) {
  std::vector<Eigen::Array2d> shown;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const ScaleFigures& f = figures[i];
    const double variance = f.variance > 0 ? f.variance : white;
    shown.emplace_back(std::log(variance), std::log(f.correlation));
    if (i == 0) continue;
    const ScaleFigures& last = figures[i - 1];
    const Eigen::Array2d growth(last.growth, last.power_growth - last.growth);
    const Eigen::Array2d most =
        shown[i - 1] +
        std::log(2.0) * (kGrowthAfterPlateau + kGrowthRatioAfterPlateau * growth.max(0.0));
    shown[i] -= chances[i - 1].flat * (shown[i] - most).max(0.0);
  }
  return shown;
}

/// Least share of the noise that the patches of a noise profile contain.
constexpr double kShownShare = 0.83;

/** The first scale whose variance is most of a given one. */
std::size_t scaleOf(double variance, const std::vector<ScaleFigures>& figures) {
  std::size_t i = 0;
  while (i + 1 < figures.size() && figures[i].variance < kShownShare * variance) ++i;
  return i;
}

/// Growth of the power, in absolute value, at which the chance that it is constant is 1/e.
constexpr double kConstantPowerGrowth = 0.42;
/// Total growth of the variance after two plateaus at which the chance of noise is 1/e.
constexpr double kGrowthAfterTwoPlateaus = 1.5;

/** Estimates the noise: moves from the figures of the smallest patches towards those of each scale,
 * by the chance that the scale is a plateau.
 *
 * 1. A row of plateaus has the figures of the first one unless the power is constant. Where the
 *    variance grows by little and the power by more, wide patches contain a little of the shape.
 * 2. After two plateaus of constant power, scales with a much larger variance do not count. */
CurveNoise weigh(const std::vector<ScaleFigures>& figures,
                 const std::vector<PlateauChance>& chances, double white,
                 const SharedNoiseConstants& constants) {
  const std::vector<Eigen::Array2d> shown = withoutShape(figures, chances, white);
  Eigen::Array2d row(std::log(white), shown.front()[1]);  // figures of the current row of plateaus
  Eigen::Array2d noise(std::log(white), 0);
  double peak = 0;        // greatest growth of the power so far
  double last = 0;        // chance that the scale before is a plateau of constant power
  double found = 0;       // greatest chance so far that two such scales in a row showed the noise
  double level = row[0];  // log variance of these two
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const double in_row = i == 0 ? 1 : std::max(chances[i - 1].flat, found);
    const double moves = std::abs(figures[i].power_growth);
    const double constant_power =
        fallOff(moves, std::max(kConstantPowerGrowth, constants.constant_power_ratio * peak));
    if (i > 0) row += (1 - in_row * (1 - constant_power)) * (shown[i] - row);
    const double beyond = 1 - fallOff((row[0] - level) / std::log(2.0), kGrowthAfterTwoPlateaus);
    noise += chances[i].slow * (1 - found * beyond) * (row - noise);
    const double plateau = chances[i].flat * constant_power;
    if (last * plateau > found) {
      found = last * plateau;
      level = row[0];
    }
    last = plateau;
    peak = std::max(peak, moves);
  }
  const double variance = std::exp(noise[0]);
  return {variance, std::exp(noise[1]), scaleOf(variance, figures)};
}

/// Least growth of two scales in a row after which wider patches show shape alone.
constexpr double kShapeAloneGrowth = 2;

/** Whether the last two scales show shape alone, as the first scales of a clean cloud do. Growth
 * beyond that of a cubic's bias is no shape: the smallest patches on a lidar's ring show no noise.
 */
bool isShape(const std::vector<PatchScale>& scales, const NoiseConstants& constants) {
  const std::size_t n = scales.size();
  if (n < 3) return false;
  ScaleFigures before, last;
  measureGrowth(scales, n - 3, constants.shared, before);
  measureGrowth(scales, n - 2, constants.shared, last);
  return std::min(before.growth, last.growth) > kShapeAloneGrowth &&
         std::max(before.growth, last.growth) < 2 * std::log2(constants.bias_growth);
}

/** Figures of a scale, measured on it and the next one. */
ScaleFigures figuresOf(const std::vector<PatchScale>& scales, std::size_t i,
                       const NoiseConstants& constants) {
  ScaleFigures figures;
  measureGrowth(scales, i, constants.shared, figures);
  measureFlatPlaces(scales[i], scales[i + 1], constants, figures);
  return figures;
}

constexpr double kLeastCorrelation = 1.5;  ///< a lesser correlation is chance [points]

/** Whether the last two scales have the same noise and no shared noise, on patches wide enough to
 * show it. Wider patches then add shape alone. */
bool isWhite(const std::vector<PatchScale>& scales, const NoiseConstants& constants) {
  const SharedNoiseConstants& shared = constants.shared;
  const std::size_t n = scales.size();
  if (n < 3 || scales[n - 3].k < 2 * shared.cells) return false;
  for (const std::size_t i : {n - 3, n - 2}) {
    const ScaleFigures f = figuresOf(scales, i, constants);
    if (std::max(std::abs(f.growth), std::abs(f.power_growth)) > shared.white_growth ||
        f.correlation >= kLeastCorrelation)
      return false;
  }
  return true;
}

/** Measures scales from patches of k points on, two at least, until wider ones add nothing. */
void measureScales(ThinnedPlaces& points, std::size_t k, std::size_t most,
                   const NoiseConstants& constants, int threads, std::vector<PatchScale>& scales) {
  const auto isKnown = [&] { return isShape(scales, constants) || isWhite(scales, constants); };
  for (; scales.size() < 2 || (k <= most && !isKnown()); k *= 2) {
    const PatchScale* narrower = scales.empty() ? nullptr : &scales.back();
    scales.push_back(measureScale(points, k, constants, threads, narrower));
  }
}

/** The noise estimated from scales. */
CurveNoise noiseOf(const std::vector<PatchScale>& scales, double white,
                   const NoiseConstants& constants) {
  std::vector<ScaleFigures> figures;
  for (std::size_t i = 0; i + 1 < scales.size(); ++i)
    figures.push_back(figuresOf(scales, i, constants));
  return weigh(figures, plateauChances(figures), white, constants.shared);
}

/** A random half of the places. */
std::vector<std::size_t> halfOf(std::size_t count, std::size_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::size_t> places(count);
  for (std::size_t s = 0; s < count; ++s) {
    places[s] = s;
    std::swap(places[s], places[random() % (s + 1)]);
  }
  places.resize(count / 2);
  return places;
}

PatchScale scaleAt(const PatchScale& scale, const std::vector<std::size_t>& places) {
  PatchScale part;
  part.k = scale.k;
  part.stride = scale.stride;
  for (const std::size_t place : places) {
    part.variances.push_back(scale.variances[place]);
    part.shared.push_back(scale.shared[place]);
    part.radii.push_back(scale.radii[place]);
  }
  return part;
}

constexpr std::size_t kHalfSamples = 8;  ///< number of random halves of the places

/** Estimates from random halves of the places. They scatter about the estimate from all places as
 * that one does about the truth (McCarthy 1969). */
std::vector<CurveNoise> halvesOf(const std::vector<PatchScale>& scales, double white,
                                 const NoiseConstants& constants, int threads) {
  std::vector<CurveNoise> halves(kHalfSamples);
  parallelFor(halves.size(), threads, 1, [&](std::size_t r, int) {
    const std::vector<std::size_t> places = halfOf(scales.front().variances.size(), r);
    std::vector<PatchScale> part(scales.size());
    std::transform(scales.begin(), scales.end(), part.begin(),
                   [&](const PatchScale& scale) { return scaleAt(scale, places); });
    halves[r] = noiseOf(part, white, constants);
  });
  return halves;
}

/** 0 up to low, 1 from high on, linear between. */
double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

/// Growth over the variance of the smallest patches from which it counts in full.
constexpr double kFullGrowth = 1.0;

/** The part of an estimate that counts: correlation and growth of the variance count by ramps. */
CurveShare shareOf(const CurveNoise& curve, double white, const SharedNoiseConstants& constants) {
  const double share = ramp(curve.correlation, kLeastCorrelation, constants.full_correlation);
  const double growth = std::log2(curve.variance / white);
  const double part = std::max(share, ramp(growth, constants.white_growth, kFullGrowth));
  // The growth is a lower bound of the correlation: the smallest patches' cubics absorb noise that
  // their points share, as on a lidar's rings.
  const double absorbed = std::min(std::exp2(part * growth), constants.full_correlation);
  return {part, white * std::exp2(part * growth),
          std::max(absorbed, 1 + share * (curve.correlation - 1))};
}

/** The scatter of the estimates from halves about the estimate from all places. */
LogErrors errorsOf(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants) {
  const CurveShare all = shareOf(curve.noise, white, constants);
  LogErrors errors;
  for (const CurveNoise& noise : curve.halves) {
    const CurveShare half = shareOf(noise, white, constants);
    errors.variance += std::pow(std::log(half.variance / all.variance), 2);
    errors.correlation += std::pow(std::log(half.correlation / all.correlation), 2);
  }
  const auto count = static_cast<double>(curve.halves.size());
  return {errors.variance / count, errors.correlation / count};
}

/// Largest RMS error of the logarithms of the variance and of the correlation.
constexpr double kLogError = 0.07;

/** The number of places that the largest error needs. */
double neededPlaces(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants) {
  const LogErrors errors = errorsOf(curve, white, constants);
  const double excess = std::max(errors.variance, errors.correlation) / (kLogError * kLogError);
  return static_cast<double>(curve.scales.front().variances.size()) * excess;
}

constexpr std::size_t kPointsPerPlace = 20;  ///< there is at most one place for this many points
constexpr std::size_t kLeastPlaces = 100;    ///< there are at least this many places

/** Measures the curve of a cloud, again with more places if random halves of them differ too much.
 * \param[in] k number of points of the smallest patches \param[in] white their variance */
NoiseCurve measureCurve(const PointStore& store, std::size_t k, double white,
                        const NoiseConstants& given, int threads) {
  NoiseConstants constants = given;
  SharedNoiseConstants& shared = constants.shared;
  // Patches of a thin part end at its borders, where the growth of the power slows down, too.
  if (store.hasSides() && !store.hasNormals())
    shared.constant_power_ratio = shared.sided_constant_power_ratio;
  const auto measure = [&](std::size_t places) {
    NoiseCurve curve;
    ThinnedPlaces points(store, places);
    measureScales(points, k, store.size() / constants.most_part, constants, threads, curve.scales);
    curve.noise = noiseOf(curve.scales, white, constants);
    curve.halves = halvesOf(curve.scales, white, constants, threads);
    return curve;
  };
  const std::size_t wanted = store.size() / kPointsPerPlace;
  const std::size_t places = std::clamp(wanted, kLeastPlaces, shared.places);
  const std::size_t most = std::min(shared.most_places, wanted);
  NoiseCurve curve = measure(places);
  const double needed = neededPlaces(curve, white, shared);
  constexpr double kLeastFactor = 4;  // the number needed is uncertain if estimated from few places
  const auto few = static_cast<double>(places);
  if (places >= most || !(needed > few)) return curve;
  const double more = std::min(std::max(needed, kLeastFactor * few), static_cast<double>(most));
  return measure(static_cast<std::size_t>(more));
}

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

/// Ratio of a place's variance to the cloud's from which a fit takes the noise for detail.
constexpr double kUnevenRatio = 2;
/// Share of such places from which the noise is uneven.
constexpr double kUnevenShare = 0.1;

/** Whether more than kUnevenShare of the places have so much more noise than the cloud that a fit
 * takes it for detail. */
bool isUneven(const PatchScale& scale, const PatchScale& wider, double variance,
              const NoiseConstants& constants, int threads) {
  const auto narrow = windowedMeans(scale.variances, constants, threads);
  const auto wide = windowedMeans(wider.variances, constants, threads);
  std::size_t noisy = 0;
  for (std::size_t s = 0; s < wide.size(); ++s)
    noisy += wide[s] > kUnevenRatio * variance && isFlat(narrow[s], wide[s], constants);
  return static_cast<double>(noisy) > kUnevenShare * static_cast<double>(wide.size());
}

/** Whether the noise is uneven on two pairs of scales: k and 2 k, 2 k and 4 k points. At an edge of
 * the surface at most one pair shows the constant variance of noise.
 * \param[in] scales the curve's, measured at the same places; reused if they begin with k points */
bool staysUneven(const PointStore& store, const NoiseLevel& noise,
                 const std::vector<PatchScale>& scales, const NoiseConstants& constants,
                 int threads) {
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
  noise.step = steps.step;
  return noise;
}

/// RMS noise below which there is only the rounding of floats [PointStore::bulkDiagonal()].
constexpr double kFloatNoise = 1e-7;

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
  const double resolved = kFloatNoise * store.bulkDiagonal();
  if (curve.noise.variance < resolved * resolved) return white;
  NoiseLevel noise = curveNoise(curve, white, static_cast<double>(store.size()), constants);
  const StepNoise steps = measureSteps(store, constants, threads);
  if (steps.step > 0 && store.size() >= 2 * constants.most_part * steps.neighbors) {
    const NoiseLevel rounding = roundingNoise(store, steps, constants, threads);
    if (noise.correlation < constants.shared.full_correlation ||
        !isFlat(noise.variance, rounding.variance, constants))
      noise = rounding;
  }
  if (!(noise.correlation > 1))
    noise.uneven = staysUneven(store, noise, scales, constants, threads);
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

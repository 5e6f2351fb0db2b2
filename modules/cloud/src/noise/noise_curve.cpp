// SPDX-License-Identifier: BSD-3-Clause
// The curve of the residual variance of cubics over the size of the patch, which separates noise that
// neighbours share from detail (docs/noise.md, "Plateaus").
#include "noise/noise_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

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

// Constants of (N4).
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

/** Evaluates (N4). */
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

/** Measures scales from patches of k points on, two at least, until wider ones add nothing.
 * \param[in] step every step-th place is measured
 * \param[in] seen the scales of such a look: the places that it left are measured; null: none */
std::vector<PatchScale> measureScales(const PointStore& store, std::size_t places, std::size_t k,
                                      const NoiseConstants& constants, int threads,
                                      std::size_t step = 1,
                                      const std::vector<PatchScale>* seen = nullptr) {
  ThinnedPlaces points(store, places);
  const std::size_t most = store.size() / constants.most_part;
  std::vector<PatchScale> scales;
  const auto isKnown = [&] { return isShape(scales, constants) || isWhite(scales, constants); };
  for (; scales.size() < 2 || (k <= most && !isKnown()); k *= 2) {
    PlaceLook look{step};
    if (seen != nullptr) {
      const std::size_t i = scales.size();
      look = i < seen->size() ? PlaceLook{step, &(*seen)[i]} : PlaceLook{};
    }
    const PatchScale* narrower = scales.empty() ? nullptr : &scales.back();
    scales.push_back(measureScale(points, k, constants, threads, narrower, look));
  }
  return scales;
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

}  // namespace

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

namespace {

/// Largest RMS error of the logarithms of the variance and of the correlation.
constexpr double kLogError = 0.07;

/** The number of places that the largest error needs. */
double neededPlaces(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants) {
  const LogErrors errors = errorsOf(curve, white, constants);
  const double excess = std::max(errors.variance, errors.correlation) / (kLogError * kLogError);
  return static_cast<double>(curve.scales.front().variances.size()) * excess;
}

/** The places of scales that a first look measured. */
std::vector<PatchScale> firstLook(const std::vector<PatchScale>& scales, std::size_t step) {
  std::vector<std::size_t> looked;
  for (std::size_t s = step / 2; s < scales.front().variances.size(); s += step)
    looked.push_back(s);
  std::vector<PatchScale> first(scales.size());
  std::transform(scales.begin(), scales.end(), first.begin(),
                 [&](const PatchScale& scale) { return scaleAt(scale, looked); });
  return first;
}

constexpr std::size_t kPointsPerPlace = 20;  ///< there is at most one place for this many points

}  // namespace

NoiseCurve measureCurve(const PointStore& store, std::size_t k, double white,
                        const NoiseConstants& given, int threads) {
  NoiseConstants constants = given;
  SharedNoiseConstants& shared = constants.shared;
  // Patches of a thin part end at its borders, where the growth of the power slows down, too.
  if (store.hasSides() && !store.hasNormals())
    shared.constant_power_ratio = shared.sided_constant_power_ratio;
  const auto curveOf = [&](std::vector<PatchScale> scales) {
    NoiseCurve curve{std::move(scales), {}, {}};
    curve.noise = noiseOf(curve.scales, white, constants);
    curve.halves = halvesOf(curve.scales, white, constants, threads);
    return curve;
  };
  const std::size_t wanted = store.size() / kPointsPerPlace;
  const std::size_t places = std::clamp(wanted, constants.least_samples, shared.places);
  const std::size_t step = places / constants.least_samples;
  const auto few = measureScales(store, places, k, constants, threads, step);
  NoiseCurve curve = curveOf(firstLook(few, step));
  // Without any error, the noise of every half is white.
  if (!(neededPlaces(curve, white, shared) > 0)) return curve;
  if (step > 1) curve = curveOf(measureScales(store, places, k, constants, threads, step, &few));
  const double needed = neededPlaces(curve, white, shared), now = static_cast<double>(places);
  const std::size_t most = std::min(shared.most_places, wanted);
  constexpr double kLeastFactor = 4;  // the number needed is uncertain if estimated from few places
  if (places >= most || !(needed > now)) return curve;
  const double more = std::min(std::max(needed, kLeastFactor * now), static_cast<double>(most));
  return curveOf(measureScales(store, static_cast<std::size_t>(more), k, constants, threads));
}

}  // namespace pcl_slim::detail

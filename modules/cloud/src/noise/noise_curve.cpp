// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": the curve of the residuals of cubics over the size
// of the patch, and what the noise is that it shows.
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

/** The noise of a cloud as its scales show it. */
struct CurveNoise {
  double variance = 0, correlation = 1;
  std::size_t scale = 0;  ///< that shows most of it
};

/** The scales of a cloud, and the noise that they show. */
struct NoiseCurve {
  std::vector<PatchScale> scales;  ///< two at least
  CurveNoise noise;
  std::vector<CurveNoise> halves;  ///< by random halves of the places: their scatter is its error
};

/** What counts of the noise that a curve shows: none where chance explains what wider patches show.
 */
struct CurveShare {
  double part = 0;  ///< of the logarithm of its variance over white noise's ...
  double variance = 0, correlation = 1;  ///< ... and the figures with that part
};

/** Squared errors of the logarithms of the figures that count. */
struct LogErrors {
  double variance = 0, correlation = 0;
};

/** From 1 at 0 to 0 beyond a width, and flat at both ends. */
double fallOff(double x, double width) {
  const double ratio = std::max(0.0, x) / width;
  return std::exp(-ratio * ratio * ratio * ratio);
}

constexpr double kPlainest =
    0.35;  ///< share of the places, those of least variance, whose growth counts ...
constexpr std::size_t kAhead = 3;  ///< ... on patches this many doublings wider

/** The places measured on every given scale, those of the least variance on the last one. */
std::vector<std::size_t> plainestPlaces(const PatchScale& narrow, const PatchScale& wider,
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

/** Binary logarithm of the ratio of two trimmed means; finite also where exact planes leave a mean
 * of 0. */
double growthOf(std::vector<double> narrow, std::vector<double> wider, double trim) {
  constexpr double kMost = 100;
  const double a = trimmedMean(narrow, trim), b = trimmedMean(wider, trim);
  if (!(a > 0) || !(b > 0)) return b > a ? kMost : a > b ? -kMost : 0;
  return std::clamp(std::log2(b / a), -kMost, kMost);
}

/** What a scale shows, and how it grows to the next. */
struct ScaleFigures {
  double variance = 0, correlation = 1;
  double growth = 0, power_growth = 0;
};

/** Growth at the plainest places of a wider scale, which do not depend on what is compared. */
void measureGrowth(const std::vector<PatchScale>& scales, std::size_t i,
                   const SharedNoiseConstants& constants, ScaleFigures& figures) {
  const PatchScale &narrow = scales[i], &wider = scales[i + 1];
  const PatchScale& widest = scales[std::min(i + kAhead, scales.size() - 1)];
  std::vector<double> variances[2], powers[2];
  for (const std::size_t s : plainestPlaces(narrow, wider, widest, kPlainest)) {
    variances[0].push_back(narrow.variances[s]);
    variances[1].push_back(wider.variances[s]);
    powers[0].push_back(narrow.power(s));
    powers[1].push_back(wider.power(s));
  }
  figures.growth = growthOf(variances[0], variances[1], constants.trim);
  figures.power_growth = growthOf(powers[0], powers[1], constants.trim);
}

constexpr double kFlatPlace = 0.5;  ///< growth up to which a place is flat

/** Level and correlation at the places where the variance grows little: they are flat at this
 * scale. */
void measureFlatPlaces(const PatchScale& scale, const PatchScale& wider,
                       const NoiseConstants& constants, ScaleFigures& figures) {
  const SharedNoiseConstants& shared = constants.shared;
  PatchScale flat;
  flat.k = scale.k;
  flat.stride = scale.stride;
  for (std::size_t s = 0; s < scale.variances.size(); ++s) {
    if (scale.variances[s] < 0 || wider.variances[s] < 0) continue;
    if (wider.variances[s] > std::exp2(kFlatPlace) * scale.variances[s]) continue;
    flat.variances.push_back(scale.variances[s]);
    flat.shared.push_back(scale.shared[s]);
    flat.radii.push_back(scale.radii[s]);
  }
  if (flat.variances.empty()) return;
  figures.variance = levelOf(flat, constants);
  if (scale.k >= 2 * shared.cells) figures.correlation = correlationOf(flat, constants);
}

/** Binary logarithm of the factor by which a scale's power is below a narrower scale's, or by which
 * that of the next few scales falls below its greatest. */
double fallAbout(const std::vector<ScaleFigures>& figures, std::size_t i) {
  double power = 0, greatest = 0, fall = 0;
  for (std::size_t j = 0; j < std::min(i + kAhead, figures.size()); ++j) {
    if (j == i) fall = greatest - power;
    if (j == i) greatest = power;
    power += figures[j].power_growth;
    greatest = std::max(greatest, power);
    if (j >= i) fall = std::max(fall, greatest - power);
  }
  return fall;
}

constexpr double kFlat = 0.33;       ///< growth at which a size of patch is no plateau
constexpr double kSlow = 0.62;       ///< the same as a share of the greatest growth before, ...
constexpr double kMostPeak = 0.8;    ///< ... of which at most this counts
constexpr double kSteep = 1.2;       ///< growth that noise does not show ...
constexpr double kSteepWidth = 0.1;  ///< ... and the width of the passage
constexpr double kFall = 0.8;        ///< fall of the power that noise does not show

/** Chances that a scale is a plateau of noise. */
struct PlateauChance {
  double slow = 0;  ///< its variance grows more slowly than before ...
  double flat = 0;  ///< ... or hardly at all
};

std::vector<PlateauChance> plateauChances(const std::vector<ScaleFigures>& figures) {
  std::vector<PlateauChance> chances;
  double gentle = 1;  // chance that no growth so far was a shape's
  double peak = 0;    // greatest growth so far
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const ScaleFigures& f = figures[i];
    const double still = fallOff(std::abs(f.power_growth), kFlat);
    const double noise = std::max(gentle, still) * fallOff(fallAbout(figures, i), kFall);
    const double slow = kSlow * std::min(peak, kMostPeak);
    chances.push_back(
        {noise * fallOff(f.growth, std::max(kFlat, slow)), noise * fallOff(f.growth, kFlat)});
    peak = std::max(peak, f.growth);
    gentle /= 1 + std::exp((f.growth - kSteep) / kSteepWidth);
  }
  return chances;
}

constexpr double kSpread =
    1.5;  ///< growth of a plateau's mean over that of plain places, at most, ...
constexpr double kCreases = 0.1;  ///< ... and added to it

/** Logarithms of every scale's variance and correlation. After a plateau they grow about as those
 * of the plainest places do: what else wider patches show is shape. */
std::vector<Eigen::Array2d> withoutShape(const std::vector<ScaleFigures>& figures,
                                         const std::vector<PlateauChance>& chances, double white) {
  std::vector<Eigen::Array2d> shown;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const ScaleFigures& f = figures[i];
    const double variance = f.variance > 0 ? f.variance : white;
    shown.emplace_back(std::log(variance), std::log(f.correlation));
    if (i == 0) continue;
    const ScaleFigures& last = figures[i - 1];
    const Eigen::Array2d plain(last.growth, last.power_growth - last.growth);
    const Eigen::Array2d most =
        shown[i - 1] + std::log(2.0) * (kCreases + kSpread * plain.max(0.0));
    shown[i] -= chances[i - 1].flat * (shown[i] - most).max(0.0);
  }
  return shown;
}

constexpr double kShownPart = 0.83;  ///< share of the noise that a profile's patches show

/** The first scale that shows most of a variance. */
std::size_t scaleOf(double variance, const std::vector<ScaleFigures>& figures) {
  std::size_t i = 0;
  while (i + 1 < figures.size() && figures[i].variance < kShownPart * variance) ++i;
  return i;
}

constexpr double kStill = 0.42;  ///< growth of the power, either way, at which it is not constant
constexpr double kBeyond = 1.5;  ///< growth beyond a plateau, in all, that noise does not show

/** Moves from what the smallest patches show towards each scale by its chance to be a plateau. A
 * run of plateaus has its first one's figures unless their power is constant: where the
 * variance grows by little and the power by more, wide patches contain a little of the shape. */
CurveNoise weigh(const std::vector<ScaleFigures>& figures,
                 const std::vector<PlateauChance>& chances, double white,
                 const SharedNoiseConstants& constants) {
  const std::vector<Eigen::Array2d> shown = withoutShape(figures, chances, white);
  Eigen::Array2d run(std::log(white), shown.front()[1]);
  Eigen::Array2d noise(std::log(white), 0);
  double peak = 0;        // greatest growth of the power so far
  double last = 0;        // chance that the scale before is a plateau of constant power ...
  double first = 0;       // ... and that two such scales in a row have shown the noise
  double level = run[0];  // of these, its variance
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const double before = i == 0 ? 1 : std::max(chances[i - 1].flat, first);
    const double moves = std::abs(figures[i].power_growth);
    const double still = fallOff(moves, std::max(kStill, constants.slowing * peak));
    if (i > 0) run += (1 - before * (1 - still)) * (shown[i] - run);
    const double beyond = 1 - fallOff((run[0] - level) / std::log(2.0), kBeyond);
    noise += chances[i].slow * (1 - first * beyond) * (run - noise);
    const double plateau = chances[i].flat * still;
    if (last * plateau > first) {
      first = last * plateau;
      level = run[0];
    }
    last = plateau;
    peak = std::max(peak, moves);
  }
  const double variance = std::exp(noise[0]);
  return {variance, std::exp(noise[1]), scaleOf(variance, figures)};
}

constexpr double kShape = 2;  ///< growth, twice in a row, after which there is shape alone

/** Whether a surface's shape has shown in full, as it does at the first scales on clean clouds.
 * More than a cubic's bias grows by is none: patches along a lidar's ring show nothing at all. */
bool isShape(const std::vector<PatchScale>& scales, const NoiseConstants& constants) {
  const std::size_t n = scales.size();
  if (n < 3) return false;
  ScaleFigures before, last;
  measureGrowth(scales, n - 3, constants.shared, before);
  measureGrowth(scales, n - 2, constants.shared, last);
  return std::min(before.growth, last.growth) > kShape &&
         std::max(before.growth, last.growth) < 2 * std::log2(constants.bias_growth);
}

/** The figures of a scale, from it and the next one. */
ScaleFigures figuresOf(const std::vector<PatchScale>& scales, std::size_t i,
                       const NoiseConstants& constants) {
  ScaleFigures figures;
  measureGrowth(scales, i, constants.shared, figures);
  measureFlatPlaces(scales[i], scales[i + 1], constants, figures);
  return figures;
}

constexpr double kLeast = 1.5;  ///< fewer neighbours than this share nothing

/** Whether two scales in a row, of patches wide enough to show it, have the same noise and no
 * shared noise: then what wider patches show is shape. */
bool isWhite(const std::vector<PatchScale>& scales, const NoiseConstants& constants) {
  const SharedNoiseConstants& shared = constants.shared;
  const std::size_t n = scales.size();
  if (n < 3 || scales[n - 3].k < 2 * shared.cells) return false;
  for (const std::size_t i : {n - 3, n - 2}) {
    const ScaleFigures f = figuresOf(scales, i, constants);
    if (std::max(std::abs(f.growth), std::abs(f.power_growth)) > shared.chance ||
        f.correlation >= kLeast)
      return false;
  }
  return true;
}

/** Measures scales from patches of k points on. */
void measureScales(ThinnedPlaces& points, std::size_t k, std::size_t most,
                   const NoiseConstants& constants, int threads, std::vector<PatchScale>& scales) {
  const auto isKnown = [&] { return isShape(scales, constants) || isWhite(scales, constants); };
  for (; scales.size() < 2 || (k <= most && !isKnown()); k *= 2) {
    const PatchScale* narrower = scales.empty() ? nullptr : &scales.back();
    scales.push_back(measureScale(points, k, constants, threads, narrower));
  }
}

/** The noise that scales show. */
CurveNoise noiseOf(const std::vector<PatchScale>& scales, double white,
                   const NoiseConstants& constants) {
  std::vector<ScaleFigures> figures;
  for (std::size_t i = 0; i + 1 < scales.size(); ++i)
    figures.push_back(figuresOf(scales, i, constants));
  return weigh(figures, plateauChances(figures), white, constants.shared);
}

/** Half of the places, at random. */
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

constexpr std::size_t kHalfSamples = 8;  ///< halves of the places whose outcomes are compared

/** The noise by halves of the places: they scatter about that of all as the latter does about the
 * truth (McCarthy 1969). */
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

/** 0 up to low, 1 from high on. */
double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

constexpr double kPlain =
    1.0;  ///< growth from the smallest patches' variance from which on all of it counts

CurveShare shareOf(const CurveNoise& curve, double white, const SharedNoiseConstants& constants) {
  const double share = ramp(curve.correlation, kLeast, constants.all);
  const double growth = std::log2(curve.variance / white);
  const double part = std::max(share, ramp(growth, constants.chance, kPlain));
  // The smallest patches' cubics absorb noise that their points share, as on a lidar's rings.
  const double taken = std::min(std::exp2(part * growth), constants.all);
  return {part, white * std::exp2(part * growth),
          std::max(taken, 1 + share * (curve.correlation - 1))};
}

/** The scatter of a curve's halves. */
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

/// RMS error wanted of the logarithms of the variance and of the number of points that share
/// errors.
constexpr double kError = 0.07;

/** The places that it takes for what counts of the noise to be known to the accuracy wanted. */
double neededPlaces(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants) {
  const LogErrors errors = errorsOf(curve, white, constants);
  const double excess = std::max(errors.variance, errors.correlation) / (kError * kError);
  return static_cast<double>(curve.scales.front().variances.size()) * excess;
}

/// One place for this many points and no fewer than this, up to SharedNoiseConstants::places.
constexpr std::size_t kPointsPerPlace = 20, kLeastPlaces = 100;

/** Measures scales, from the smallest patches on, until no wider one can show noise, and weighs
 * what each shows by the chance that it is a plateau (docs/theory.md, "Noise that neighbours
 * share").
 * \param[in] white variance by the smallest patches */
NoiseCurve measureCurve(const PointStore& store, std::size_t k, double white,
                        const NoiseConstants& given, int threads) {
  NoiseConstants constants = given;
  SharedNoiseConstants& shared = constants.shared;
  // Patches of a thin part end at its borders, where the power slows down, too.
  if (store.hasSides() && !store.hasNormals()) shared.slowing = shared.sided_slowing;
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
  constexpr double kMore = 4;  // few places do not know well how many it takes
  const auto few = static_cast<double>(places);
  if (places >= most || !(needed > few)) return curve;
  const double more = std::min(std::max(needed, kMore * few), static_cast<double>(most));
  return measure(static_cast<std::size_t>(more));
}

constexpr std::size_t kPlaces = 1200;  ///< where patches that show all of a rounding are compared
constexpr double kRoundingFlat = 0.7;  ///< growth beyond those patches that is a surface's

/** The noise of a rounded coordinate, whose errors change sign from one terrace to the next, so
 * that wide cells share nothing. Where detail follows directly, patches of half the width show it.
 * \param[in] k points of patches that show all of it \param[out] scales those measured */
CurveNoise measureRounding(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                           int threads, std::vector<PatchScale>& scales) {
  ThinnedPlaces points(store, kPlaces);
  for (const std::size_t size : {k / 2, k, 2 * k})
    scales.push_back(measureScale(points, size, constants, threads));
  const double narrow = levelOf(scales[0], constants), wide = levelOf(scales[1], constants);
  const double growth = std::log2(median(scales[2].variances) / median(scales[1].variances));
  const double chance = fallOff(growth, kRoundingFlat);
  const double least = constants.shared.all;
  const double shared = std::max(least, correlationOf(scales[2], constants));
  return {narrow * std::pow(wide / narrow, chance), least * std::pow(shared / least, chance), 1};
}

constexpr double kUneven = 2;  ///< variance over the cloud's from which noise passes for detail
constexpr double kUnevenShare =
    0.1;  ///< share of places of this noise from which a profile is made

/** Whether a share of places has more noise than the cloud by a factor that a fit takes for detail.
 */
bool isUneven(const PatchScale& scale, const PatchScale& wider, double variance,
              const NoiseConstants& constants, int threads) {
  const auto narrow = windowedMeans(scale.variances, constants, threads);
  const auto wide = windowedMeans(wider.variances, constants, threads);
  std::size_t noisy = 0;
  for (std::size_t s = 0; s < wide.size(); ++s)
    noisy += wide[s] > kUneven * variance && isFlat(narrow[s], wide[s], constants);
  return static_cast<double>(noisy) > kUnevenShare * static_cast<double>(wide.size());
}

/** The same on two pairs of scales: an edge's residual is noise to one of them at most.
 * \param[in] scales the first two of a curve, from the noise's own patches on or not; all are
 * measured at their places */
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

/// Of more points fits count the geometric mean with this: a wide tau rounds edges, and a part of
/// it costs smooth parts little.
constexpr double kCounted = 12;

/** Sets how many points share their errors, and as how many of these a fit counts one. */
void setCorrelation(double correlation, NoiseLevel& noise) {
  noise.correlation = noise.dependence = correlation;
  if (correlation > kCounted) noise.dependence = std::sqrt(kCounted * correlation);
}

/** The noise that one scale shows. */
NoiseLevel scaleNoise(const PatchScale& scale, const NoiseConstants& constants) {
  NoiseLevel noise;
  noise.variance = levelOf(scale, constants);
  noise.error = 0.5 * trimmedMeanError(scale.variances, constants.trim);
  noise.patch_radius = median(scale.radii);
  noise.neighbors = scale.k;
  return noise;
}

/** Sets the errors of a curve's noise: the scatter of its halves, that of a variance of as many
 * values as the cloud has independent errors, and white noise's own. */
void setErrors(const NoiseCurve& curve, const CurveShare& all, const NoiseLevel& white,
               double points, const SharedNoiseConstants& constants, NoiseLevel& noise) {
  const LogErrors errors = errorsOf(curve, white.variance, constants);
  const double chance = all.part * 2 * all.correlation / points;
  noise.error = std::hypot(0.5 * std::sqrt(errors.variance + chance), (1 - all.part) * white.error);
  noise.correlation_error = std::sqrt(errors.correlation + chance);
}

/** The noise of a curve. */
NoiseLevel curveNoise(const NoiseCurve& curve, const NoiseLevel& white, double points,
                      const NoiseConstants& constants) {
  const SharedNoiseConstants& shared = constants.shared;
  const CurveShare share = shareOf(curve.noise, white.variance, shared);
  NoiseLevel noise = share.correlation > shared.white
                         ? scaleNoise(curve.scales[curve.noise.scale], constants)
                         : white;
  noise.variance = share.variance;
  if (share.correlation > shared.white) setCorrelation(share.correlation, noise);
  setErrors(curve, share, white, points, shared, noise);
  return noise;
}

/** Rounding of a coordinate where there is little other noise. */
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

constexpr double kResolved =
    1e-7;  ///< RMS noise below which there is rounding of floats alone [L of the bulk]

/** White noise of points on lines: across a line its points count as one independent point. */
NoiseLevel alongLines(const NoiseLevel& white) {
  NoiseLevel noise = white;
  noise.dependence = static_cast<double>(white.line);
  return noise;
}

}  // namespace

NoiseLevel recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                                const NoiseConstants& constants, int threads) {
  if (white.neighbors == 0) return white;
  if (white.line > 0) return alongLines(white);
  threads = resolveThreads(threads);
  const NoiseCurve curve = measureCurve(store, white.neighbors, white.variance, constants, threads);
  const std::vector<PatchScale>& scales = curve.scales;
  const double resolved = kResolved * store.bulkDiagonal();
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

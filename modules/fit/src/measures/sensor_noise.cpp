// SPDX-License-Identifier: BSD-3-Clause
// The noise of a sensor, measured on one frame and used for the next ones (docs/noise.md, "A
// sensor's next frame").
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "least_squares/dense.h"
#include "measures/measures.h"
#include "pcl_slim/cloud/detail/patch_residuals.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

using Places = std::vector<PlaceResiduals>;

/// Least cosine between ray and surface: the plane through a noisy patch is no surer.
constexpr double kLeastCosine = 0.2;

/** The rays from the place that the cloud was seen from; none where it is not known. */
std::vector<SensorRay> raysOf(const PointStore& store, const FitParams& params, std::size_t runs,
                              const NoiseConstants& constants, int threads) {
  const std::optional<Vector3> sensor = localViewpoint(store, params);
  if (!sensor) return {};
  return raysToRuns(store, sensor, runs, constants, threads);
}

double errorAt(const std::array<double, 3>& error, double z) {
  return error[0] + error[1] * z + error[2] * z * z;
}

/** The variance across the surface that a sensor's error causes at a place [squared world unit]. */
double varianceAt(const SensorNoise& noise, const PlaceResiduals& place, double scale) {
  if (!noise.along_rays) return noise.error[0] * noise.error[0];
  const double across =
      errorAt(noise.error, place.ray.range * scale) * std::max(place.ray.cosine, kLeastCosine);
  return across * across;
}

// Most places of a frame are smooth at the size of a patch; others add detail to the residual.
constexpr double kLeastQuantile = 0.1, kMostQuantile = 0.5;  ///< of the places whose mean counts

/** Mean between two quantiles, of 8 values or more. */
double lowerMean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return static_cast<std::size_t>(share * static_cast<double>(values.size()));
  };
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(at(kLeastQuantile));
  const auto end = values.begin() + static_cast<std::ptrdiff_t>(at(kMostQuantile));
  return std::accumulate(first, end, 0.0) / static_cast<double>(end - first);
}

/** An RMS and its standard error; infinite where there are too few values. */
struct Estimate {
  double rms = 0, error = HUGE_VAL;
};

/** The root of lowerMean() with the error that eight interleaved parts of the values show. */
Estimate estimateOf(const std::vector<double>& values) {
  constexpr std::size_t kParts = 8;
  if (values.size() < kParts * kParts) return {};
  const double rms = std::sqrt(lowerMean(values));
  double squares = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<double> some;
    for (std::size_t i = part; i < values.size(); i += kParts) some.push_back(values[i]);
    squares += std::pow(std::sqrt(lowerMean(std::move(some))) - rms, 2);
  }
  return {rms, std::sqrt(squares / (kParts * (kParts - 1)))};
}

/** RMS residual on patches of one size, as a share of a sensor's RMS error.
 * \param[in] least, most bounds of the range of the places that count [local length] */
Estimate residualShare(const SensorNoise& noise, const Places& places, std::size_t size,
                       double scale, double least, double most) {
  std::vector<double> shares;
  for (const PlaceResiduals& place : places) {
    const double variance = place.variances[size];
    if (variance < 0 || place.ray.range < least || place.ray.range >= most) continue;
    shares.push_back(variance * scale * scale / varianceAt(noise, place, scale));
  }
  return estimateOf(shares);
}

/// Numbers of points of the narrow and the wide patches that a check compares.
constexpr std::array<std::size_t, 2> kPatchSizes = {40, 320};
constexpr std::size_t kCheckedPlaces = 256;  ///< of a frame that is compared with a sensor's noise
constexpr std::size_t kMeasuredPlaces = 1000;  ///< of a frame on which it is measured

/** How a frame's residuals agree with a sensor's noise. */
struct Agreement {
  SensorCheck check = SensorCheck::kNotSeen;
  double ratio = 0;   ///< RMS residual over the sensor's, of the wide patches that differ most
  double radius = 0;  ///< median of the wide patches [local length]
};

// RMS residuals agree if they differ by no more than this, beyond twice their standard error. A fit
// with too small a noise follows it (sigma x .85 in white frames of a room: position error + 4 to
// 32 %), one with too large a noise loses little (x 1.2: nothing there).
constexpr double kMostAbove = 0.06;  ///< of a frame with more noise [its residual]
constexpr double kMostBelow = 0.15;  ///< of a frame with less noise [the sensor's residual]
/// The same of narrow patches, whose residual depends on the range where noise or steps fill them.
/// They show noise that is shared by another number of points [RMS error].
constexpr double kMostNarrow = 0.2;
/// Largest standard error of an RMS residual that shows anything [RMS error].
constexpr double kMostError = 0.05;

/** Compares the narrow patches of a frame, and the wide ones of its nearer and its farther half. */
Agreement compareWith(const SensorNoise& noise, const PointStore& store,
                      const std::vector<SensorRay>& rays, const NoiseConstants& constants,
                      int threads) {
  Agreement agreement;
  const Places places = residualsAtPlaces(store, kPatchSizes, kCheckedPlaces, rays, constants,
                                          threads, agreement.radius);
  const double scale = store.scale();
  const auto difference = [&](std::size_t size, const Estimate& found) {
    const double error = std::hypot(found.error, noise.residual_error[size]);
    return std::max(0.0, std::abs(found.rms - noise.residual[size]) - 2 * error);
  };
  const Estimate narrow = residualShare(noise, places, 0, scale, 0, HUGE_VAL);
  bool seen = narrow.error < kMostError, agrees = difference(0, narrow) < kMostNarrow;
  std::vector<double> ranges;
  for (const PlaceResiduals& place : places) ranges.push_back(place.ray.range);
  const double middle = noise.along_rays ? median(ranges) : HUGE_VAL;
  const std::array<double, 3> bounds = {0, middle, HUGE_VAL};
  for (std::size_t part = 0; part < (noise.along_rays ? 2 : 1); ++part) {
    const Estimate wide = residualShare(noise, places, 1, scale, bounds[part], bounds[part + 1]);
    seen = seen && wide.error < kMostError;
    const double expected = noise.residual[1], ratio = wide.rms / expected;
    const double most = ratio > 1 ? kMostAbove * wide.rms : kMostBelow * expected;
    agrees = agrees && difference(1, wide) < most;
    if (part == 0 || std::abs(std::log(ratio)) > std::abs(std::log(agreement.ratio)))
      agreement.ratio = ratio;
  }
  if (seen) agreement.check = agrees ? SensorCheck::kAgrees : SensorCheck::kDiffers;
  return agreement;
}

/** RMS error along the ray at a range, of places of about this range. */
struct RangeBin {
  double range = 0, error = 0;
};

/** The error by range, as the wide patches show it. */
std::vector<RangeBin> binsByRange(Places places, double scale) {
  constexpr std::size_t kMostBins = 16, kLeastInBin = 40;
  const auto isUnknown = [](const PlaceResiduals& place) { return place.variances[1] < 0; };
  places.erase(std::remove_if(places.begin(), places.end(), isUnknown), places.end());
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.ray.range < b.ray.range; });
  const std::size_t bins = std::clamp<std::size_t>(places.size() / kLeastInBin, 1, kMostBins);
  std::vector<RangeBin> found;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t begin = b * places.size() / bins, end = (b + 1) * places.size() / bins;
    std::vector<double> along;
    for (std::size_t i = begin; i < end; ++i) {
      const double cosine = std::max(places[i].ray.cosine, kLeastCosine);
      along.push_back(places[i].variances[1] / (cosine * cosine));
    }
    const double variance = lowerMean(std::move(along));
    if (variance > 0)
      found.push_back({places[(begin + end) / 2].ray.range * scale, std::sqrt(variance) * scale});
  }
  return found;
}

/** Least squares of the relative errors by some of the terms 1, z, z^2. \return their factors;
 * none where one would be negative \param[out] squares sum of the squared relative residuals */
std::optional<std::array<double, 3>> fitTerms(const std::vector<RangeBin>& bins, unsigned terms,
                                              double& squares) {
  std::array<int, 3> powers{};
  Eigen::Index count = 0;
  for (int power = 0; power < 3; ++power) {
    if (terms & 1u << power) powers[static_cast<std::size_t>(count++)] = power;
  }
  const auto rows = static_cast<Eigen::Index>(bins.size());
  if (count >= rows) return {};
  Eigen::MatrixXd matrix(rows, count);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const RangeBin& bin = bins[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < count; ++j)
      matrix(i, j) = std::pow(bin.range, powers[static_cast<std::size_t>(j)]) / bin.error;
  }
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(rows);
  const Eigen::VectorXd factors = solveLeastSquares(matrix, ones);
  squares = (matrix * factors - ones).squaredNorm();
  std::array<double, 3> error{};
  for (Eigen::Index j = 0; j < count; ++j) {
    if (!(factors[j] >= 0)) return {};
    error[static_cast<std::size_t>(powers[static_cast<std::size_t>(j)])] = factors[j];
  }
  return error;
}

/** The polynomial of the least cross-validated residual (Craven and Wahba 1979), with no term below
 * 0. A frame whose range hardly varies cannot tell the terms apart; then a wrong one shows in the
 * frames of other ranges. */
std::optional<std::array<double, 3>> errorByRange(const std::vector<RangeBin>& bins) {
  const auto n = static_cast<double>(bins.size());
  std::optional<std::array<double, 3>> best;
  double least = HUGE_VAL;
  for (const unsigned terms : {4u, 2u, 1u, 6u, 5u, 3u, 7u}) {
    double squares = 0;
    const auto error = fitTerms(bins, terms, squares);
    const double freedom = n - static_cast<double>((terms & 1) + (terms >> 1 & 1) + (terms >> 2));
    if (!error || !(squares / (freedom * freedom) < least)) continue;
    least = squares / (freedom * freedom);
    best = error;
  }
  return best;
}

/** The coefficients of a sensor's error in local units. */
std::array<double, 3> localError(const std::array<double, 3>& error, double scale) {
  return {error[0] / scale, error[1], error[2] * scale};
}

/** The level of a frame as the measurement has it: the mean without the least and the greatest. */
double levelOf(std::vector<float> variances, const NoiseConstants& constants) {
  std::sort(variances.begin(), variances.end());
  const auto cut =
      static_cast<std::ptrdiff_t>(constants.trim * static_cast<double>(variances.size()));
  const double sum = std::accumulate(variances.begin() + cut, variances.end() - cut, 0.0);
  return sum / static_cast<double>(static_cast<std::ptrdiff_t>(variances.size()) - 2 * cut);
}

/** The variance of a frame as a multiple of what an error by range causes. Where the noise was
 * measured along the frame the median counts, because detail is in some of the runs. */
double shareOfShape(const std::vector<float>& shape, const CloudMeasures& measures,
                    const NoiseConstants& constants) {
  const std::vector<float>& profile = measures.noise_profile;
  if (profile.size() != shape.size()) return measures.lambda / levelOf(shape, constants);
  std::vector<double> shares;
  for (std::size_t j = 0; j < shape.size(); ++j) {
    if (shape[j] > 0) shares.push_back(measures.lambda * profile[j] / shape[j]);
  }
  return shares.empty() ? 0 : median(std::move(shares));
}

/** The error along rays in proportion to the residuals of a frame, if these follow a polynomial of
 * the range. */
void measureByRange(const std::vector<SensorRay>& rays, const Places& places,
                    const CloudMeasures& measures, double scale, const NoiseConstants& constants,
                    int threads, SensorNoise& noise) {
  const auto shape = errorByRange(binsByRange(places, scale));
  if (!shape) return;
  const double share = shareOfShape(rangeNoise(rays, localError(*shape, scale), constants, threads),
                                    measures, constants);
  if (!(share > 0) || !std::isfinite(share)) return;
  noise.error = *shape;
  for (double& term : noise.error) term *= std::sqrt(share);
  noise.along_rays = true;
}

NoiseLevel levelOf(const SensorNoise& noise, const PointStore& store, double variance,
                   double radius) {
  NoiseLevel level;
  level.variance = variance;
  level.error = noise.relative_error;
  level.neighbors = noise.neighbors;
  level.patch_radius = radius * std::sqrt(static_cast<double>(noise.neighbors) /
                                          static_cast<double>(kPatchSizes[1]));
  level.patches = kCheckedPlaces;
  level.line = noise.line;
  level.correlation = noise.correlation;
  level.correlation_error = noise.correlation_error;
  level.dependence = noise.dependence;
  level.step = noise.step / store.scale();
  return level;
}

}  // namespace

std::optional<SensedNoise> noiseOfSensor(const PointStore& store, const FitParams& params,
                                         const NoiseConstants& constants, int threads,
                                         NoiseStatistics& statistics) {
  if (!params.sensor_noise) return {};
  const SensorNoise& noise = *params.sensor_noise;
  statistics.sensor_check = SensorCheck::kNotSeen;
  if (store.hasSensors() || store.hasFrameNumbers()) return {};
  if (noise.along_rays && !params.viewpoint) return {};
  const std::vector<SensorRay> rays =
      noise.along_rays ? raysOf(store, params, 0, constants, threads) : std::vector<SensorRay>();
  const Agreement agreement = compareWith(noise, store, rays, constants, threads);
  statistics.sensor_check = agreement.check;
  statistics.sensor_ratio = agreement.ratio;
  if (agreement.check != SensorCheck::kAgrees) return {};
  const double plain = noise.error[0] / store.scale();
  SensedNoise sensed;
  if (noise.along_rays)
    sensed.profile = rangeNoise(rays, localError(noise.error, store.scale()), constants, threads);
  const double variance = noise.along_rays ? levelOf(sensed.profile, constants) : plain * plain;
  sensed.level = levelOf(noise, store, variance, agreement.radius);
  if (params.local_noise == false) sensed.profile.clear();
  return sensed;
}

std::optional<SensorNoise> describeSensor(const PointStore& store, const FitParams& params,
                                          const NoiseLevel& level, const CloudMeasures& measures,
                                          const NoiseConstants& constants, int threads) {
  if (store.hasSensors() || store.hasFrameNumbers() || !(level.variance > 0)) return {};
  const double scale = store.scale();
  SensorNoise noise;
  noise.error = {std::sqrt(level.variance) * scale, 0, 0};
  noise.relative_error = level.error;
  noise.correlation = level.correlation;
  noise.correlation_error = level.correlation_error;
  noise.dependence = level.dependence;
  noise.step = level.step * scale;
  noise.line = level.line;
  noise.neighbors = level.neighbors;
  double radius = 0;
  const std::vector<SensorRay> rays =
      raysOf(store, params, measures.noise_profile.size(), constants, threads);
  const Places places =
      residualsAtPlaces(store, kPatchSizes, kMeasuredPlaces, rays, constants, threads, radius);
  if (!rays.empty()) measureByRange(rays, places, measures, scale, constants, threads, noise);
  for (std::size_t size = 0; size < noise.residual.size(); ++size) {
    const Estimate found = residualShare(noise, places, size, scale, 0, HUGE_VAL);
    noise.residual[size] = found.rms;
    noise.residual_error[size] = found.error;
  }
  if (noise.validate()) return {};
  return noise;
}

}  // namespace pcl_slim::detail

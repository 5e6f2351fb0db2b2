// SPDX-License-Identifier: BSD-3-Clause
#include "measures/measures.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "least_squares/dense.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/detail/patch_residuals.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

constexpr int kTerms = 10;  ///< of a cubic

/** The sums of one patch; squares < 0: none. */
struct PatchSums {
  double squares = -1;  ///< variance of the slopes' residuals, both directions
  double own_sq = 0, tilt_sq = 0, tilt_product = 0;
  double pair_sq = 0, pair_product = 0;
};

/** A patch in a frame, in units of its radius: terms of a cubic, heights and the normals' slopes.
 */
struct FramedPatch {
  Eigen::MatrixXd terms;   ///< a row a point
  Eigen::MatrixXd values;  ///< rows of the height and two slopes
};

/** Those of the neighbours whose normals turn about as the sample's. */
void keepOwnSide(const PointStore& store, std::size_t sample, float least_cosine,
                 std::vector<std::uint32_t>& neighbors) {
  const auto own = store.normal(sample);
  const auto turned = [&](std::uint32_t j) {
    const auto n = store.normal(j);
    return n[0] * own[0] + n[1] * own[1] + n[2] * own[2] < least_cosine;
  };
  neighbors.erase(std::remove_if(neighbors.begin(), neighbors.end(), turned), neighbors.end());
}

FramedPatch framePatch(const PointStore& store, const std::vector<std::uint32_t>& points,
                       double radius, double least_cosine) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t j : points) {
    const auto n = store.normal(j);
    mean += Eigen::Vector3d(n[0], n[1], n[2]);
  }
  mean.normalize();
  const LocalFrame frame({mean[0], mean[1], mean[2]});
  const Eigen::Map<const Eigen::Vector3d> u(frame.u.data()), v(frame.v.data()), w(frame.w.data());
  const auto center = store.position(points.front());
  const auto count = static_cast<Eigen::Index>(points.size());
  FramedPatch patch;
  patch.terms.resize(count, kTerms);
  patch.values.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::uint32_t j = points[static_cast<std::size_t>(i)];
    const auto p = store.position(j);
    const auto n = store.normal(j);
    const Eigen::Vector3d offset(p[0] - center[0], p[1] - center[1], p[2] - center[2]);
    const Eigen::Vector3d normal(n[0], n[1], n[2]);
    const double x = offset.dot(u) / radius, y = offset.dot(v) / radius;
    patch.terms.row(i) << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
    const double cosine = std::max(normal.dot(w), least_cosine);
    patch.values.row(i) << offset.dot(w) / radius, -normal.dot(u) / cosine, -normal.dot(v) / cosine;
  }
  return patch;
}

PatchSums measurePatch(const FramedPatch& patch, const NormalErrorConstants& constants) {
  const Eigen::Index count = patch.values.rows();
  const Eigen::MatrixXd residuals =
      patch.values - patch.terms * solveLeastSquares(patch.terms, patch.values);
  const auto slopes = residuals.rightCols<2>();
  // The plane through the noise of the points next to the sample.
  const auto tilt_points = static_cast<Eigen::Index>(constants.tilt_points);
  const Eigen::MatrixXd plane = solveLeastSquares(patch.terms.topLeftCorner(tilt_points, 3),
                                                  residuals.topLeftCorner(tilt_points, 1));
  const Eigen::Vector2d tilt(plane(1, 0), plane(2, 0)), own = slopes.row(0);
  PatchSums sums;
  sums.squares = slopes.squaredNorm() / static_cast<double>(count - kTerms);
  sums.own_sq = own.squaredNorm();
  sums.tilt_sq = tilt.squaredNorm();
  sums.tilt_product = own.dot(tilt);
  for (Eigen::Index i = 1; i <= static_cast<Eigen::Index>(constants.pairs); ++i) {
    sums.pair_sq += 0.5 * (own.squaredNorm() + slopes.row(i).squaredNorm());
    sums.pair_product += own.dot(slopes.row(i).transpose());
  }
  return sums;
}

NormalError summarize(const std::vector<PatchSums>& patches,
                      const NormalErrorConstants& constants) {
  PatchSums all;
  std::vector<double> variances;
  for (const PatchSums& patch : patches) {
    if (!(patch.squares >= 0)) continue;
    variances.push_back(patch.squares);
    all.own_sq += patch.own_sq;
    all.tilt_sq += patch.tilt_sq;
    all.tilt_product += patch.tilt_product;
    all.pair_sq += patch.pair_sq;
    all.pair_product += patch.pair_product;
  }
  NormalError error;
  if (variances.size() < constants.least_patches) return error;
  std::sort(variances.begin(), variances.end());
  const auto cut = static_cast<std::size_t>(constants.trim * static_cast<double>(variances.size()));
  double sum = 0;
  for (std::size_t i = cut; i < variances.size() - cut; ++i) sum += variances[i];
  error.radians = std::sqrt(sum / static_cast<double>(variances.size() - 2 * cut));
  if (all.own_sq > 0 && all.tilt_sq > 0)
    error.with_heights = all.tilt_product / std::sqrt(all.own_sq * all.tilt_sq);
  if (all.pair_sq > 0) error.with_neighbors = all.pair_product / all.pair_sq;
  return error;
}

}  // namespace

NormalError measureNormalError(const PointStore& store, const NormalErrorConstants& constants,
                               int threads) {
  const std::size_t samples = std::min(constants.samples, store.size());
  std::vector<PatchSums> patches(samples);
  threads = resolveThreads(threads);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  parallelFor(samples, threads, 16, [&](std::size_t s, int thread) {
    const std::size_t sample = (2 * s + 1) * store.size() / (2 * samples);
    std::vector<std::uint32_t> neighbors;
    std::vector<float> distances_sq;
    searches[static_cast<std::size_t>(thread)].nearest(sample, constants.neighbors, neighbors,
                                                       distances_sq);
    keepOwnSide(store, sample, constants.own_side, neighbors);
    if (neighbors.size() < constants.least_points) return;
    const double radius = std::sqrt(distances_sq.back());
    patches[s] =
        measurePatch(framePatch(store, neighbors, radius, constants.least_cosine), constants);
  });
  return summarize(patches, constants);
}

namespace {

/** Whether lambda is the residual estimate, rather than given or the paper's. */
bool measuresResiduals(const FitParams& params) {
  return !params.lambda && !params.paper_mode && !params.hasThreshold();
}

/** The noise level by the residual estimate. */
NoiseLevel residualNoise(const PointStore& store, const FitParams& params,
                         const NoiseConstants& constants, int threads) {
  const std::optional<double> given = params.noise_correlation;
  if (given > 1) return measureSharedNoise(store, *given, constants, threads);
  const NoiseLevel white = measureNoise(store, constants, threads);
  return measuresResiduals(params) && !given ? recognizeFrameNoise(store, white, constants, threads)
                                             : white;
}

/** The noise model's variances for runs of points, in local units. */
std::vector<float> modelProfile(const PointStore& store, const FitParams& params,
                                const NoiseConstants& constants, int threads) {
  const auto& [a, b, c] = *params.noise_model;
  const double scale = store.scale();
  const auto rays = raysToRuns(store, localViewpoint(store, params), 0, constants, threads);
  return rangeNoise(rays, {a / scale, b, c * scale}, constants, threads);
}

/** Sets lambda to a profile's mean and the profile to ratios of it. */
void takeVariances(std::vector<float> variances, float least, CloudMeasures& measures) {
  double sum = 0;
  for (const float variance : variances) sum += variance;
  const double mean = sum / static_cast<double>(variances.size());
  measures.lambda = mean;
  if (!(mean > 0)) return;
  for (float& variance : variances)
    variance = std::clamp(static_cast<float>(variance / mean), least, 1 / least);
  measures.noise_profile = std::move(variances);
}

/** The paper's T_MDL belongs to its lambda; the default penalty to the residual estimate. */
double noiseVariance(const PointStore& store, const FitParams& params, const NoiseLevel& residual,
                     int threads) {
  const double diagonal = store.diagonal();
  if (params.lambda) return *params.lambda * diagonal * diagonal;
  return measuresResiduals(params) ? residual.variance : measurePaperNoise(store, threads).variance;
}

/** How noise varies over the cloud, if the user or the data show that it does. */
void measureProfile(const PointStore& store, const FitParams& params, const NoiseLevel& residual,
                    const NoiseConstants& constants, int threads, CloudMeasures& measures) {
  const bool shared = measures.correlation > 1;
  if (params.noise_model) {
    takeVariances(modelProfile(store, params, constants, threads), constants.least_ratio, measures);
  } else if (params.local_noise == false) {
    return;
  } else if (params.local_noise == true || measuresResiduals(params)) {
    if (shared)
      measures.noise_profile = measureNoiseProfile(store, residual, constants, threads);
    else
      measures.noise_profile =
          measureNoiseField(store, residual, params.local_noise == true, constants, threads);
  }
}

NoiseStatistics statisticsOf(const NoiseLevel& residual, double diagonal) {
  NoiseStatistics found;
  found.error = residual.error;
  found.correlation = residual.correlation;
  found.correlation_error = residual.correlation_error;
  found.frames = residual.frames;
  found.line = residual.dependence > 1 ? residual.line : 0;
  found.step = residual.step / diagonal;
  found.neighbors = residual.neighbors;
  found.patch_radius = residual.patch_radius / diagonal;
  return found;
}

/** The cosine above which two normals belong together. */
float minDot(const PointStore& store, const FitParams& params, const FitConstants& constants) {
  if (params.sharp_features) return constants.preset.sharp_bound;
  if (!store.hasSides() || params.paper_mode) return 0.0f;
  return normalBound(store, constants.normal_bound);
}

/** What normals weigh as data: the error stated, or the one measured if it is their own. */
void measureNormals(const PointStore& store, const FitParams& params, int threads,
                    CloudMeasures& measures) {
  if (params.normal_error) {
    measures.normal_error = *params.normal_error;
  } else {
    const NormalError measured = measureNormalError(store, {}, threads);
    measures.statistics.normals_follow_points = !measured.independent();
    measures.normal_error = measured.independent() ? measured.radians : 0;
  }
  measures.statistics.normal_error = measures.normal_error;
}

/** Measures the noise. */
void measureErrors(const PointStore& store, const FitParams& params, const NoiseConstants& noise,
                   int threads, CloudMeasures& measures) {
  const bool by_residuals = measuresResiduals(params);
  NoiseLevel residual;
  if (by_residuals || (params.local_noise == true && !params.noise_model))
    residual = residualNoise(store, params, noise, threads);
  if (!params.noise_model) measures.lambda = noiseVariance(store, params, residual, threads);
  measures.correlation = params.noise_correlation.value_or(by_residuals ? residual.dependence : 1);
  measureProfile(store, params, residual, noise, threads, measures);
  NoiseStatistics& statistics = measures.statistics;
  if (by_residuals)
    statistics = statisticsOf(residual, store.diagonal());
  else
    statistics.correlation = measures.correlation;
  statistics.patches = residual.patches + measures.noise_profile.size();
  if (by_residuals && (params.keep_sensor_noise || params.sensor_noise))
    statistics.sensor_noise = describeSensor(store, params, residual, measures, noise, threads);
}

/** Takes the noise of the frame's sensor instead, if there is one that the frame agrees with.
 * \param[out] check what became of it */
bool takeSensorNoise(const PointStore& store, const FitParams& params, const NoiseConstants& noise,
                     int threads, NoiseStatistics& check, CloudMeasures& measures) {
  std::optional<SensedNoise> sensed = noiseOfSensor(store, params, noise, threads, check);
  if (!sensed) return false;
  measures.lambda = sensed->level.variance;
  measures.correlation = sensed->level.dependence;
  if (!sensed->profile.empty())
    takeVariances(std::move(sensed->profile), noise.least_ratio, measures);
  measures.statistics = statisticsOf(sensed->level, store.diagonal());
  measures.statistics.patches = sensed->level.patches;
  measures.statistics.sensor_noise = params.sensor_noise;
  return true;
}

}  // namespace

std::optional<Vector3> localViewpoint(const PointStore& store, const FitParams& params) {
  if (!params.viewpoint) return {};
  Vector3 viewpoint;
  for (std::size_t a = 0; a < 3; ++a)
    viewpoint[a] = ((*params.viewpoint)[a] - store.origin()[a]) / store.scale();
  return viewpoint;
}

CloudMeasures measureCloud(const PointStore& store, const FitParams& params,
                           const FitConstants& constants, int threads) {
  CloudMeasures measures;
  measures.min_dot = minDot(store, params, constants);
  NoiseStatistics check;
  if (!takeSensorNoise(store, params, constants.noise, threads, check, measures))
    measureErrors(store, params, constants.noise, threads, measures);
  measures.noise = measures.lambda;
  measures.statistics.sensor_check = check.sensor_check;
  measures.statistics.sensor_ratio = check.sensor_ratio;
  measures.statistics.varies = !measures.noise_profile.empty();
  if (params.normals_as_data) measureNormals(store, params, threads, measures);
  return measures;
}

Error checkNormals(const PointStore& store, const FitParams& params) {
  if (!params.normals_as_data || store.hasNormals()) return {};
  return {ErrorCode::kBadInput,
          "the points have no normals to take as data: give some, or leave it"};
}

}  // namespace pcl_slim::detail

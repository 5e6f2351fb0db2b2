// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_measures.h"

#include <algorithm>
#include <utility>

#include "ball/normal_error.h"
#include "pcl_slim/cloud/detail/noise.h"

namespace pcl_slim::detail {

namespace {

/** Whether lambda is the residual estimate, rather than given or the paper's. */
bool
measuresResiduals(const FitParams& params)
{
  return !params.lambda && !params.paper_mode && !params.hasThreshold();
}

/** The noise level by the residual estimate, measured once, at the first request. */
class ResidualNoise {
 public:
  ResidualNoise(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
                int threads, FitStatistics& stats)
      : store_(store), params_(params), constants_(constants), threads_(threads), stats_(stats)
  {
  }

  const NoiseLevel& level()
  {
    if (!measured_) {
      level_ = measure();
      stats_.noise.patches += level_.patches;
    }
    measured_ = true;
    return level_;
  }

 private:
  NoiseLevel measure() const
  {
    const std::optional<double> given = params_.noise_correlation;
    if (given > 1) return measureSharedNoise(store_, *given, constants_, threads_);
    const NoiseLevel white = measureNoise(store_, constants_, threads_);
    return measuresResiduals(params_) && !given
               ? recognizeFrameNoise(store_, white, constants_, threads_)
               : white;
  }

  const PointStore& store_;
  const FitParams& params_;
  const NoiseConstants& constants_;
  int threads_;
  FitStatistics& stats_;
  NoiseLevel level_;
  bool measured_ = false;
};

/** The noise model's variances for runs of points, in local units. */
std::vector<float>
modelProfile(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
             int threads)
{
  RangeError error;
  const double scale = store.scale();
  error.own_sensors = store.hasSensors() && !params.viewpoint;
  for (std::size_t a = 0; a < 3 && params.viewpoint; ++a)
    error.sensor[a] = ((*params.viewpoint)[a] - store.origin()[a]) / scale;
  const auto& [a, b, c] = *params.noise_model;
  error.a = a / scale;
  error.b = b;
  error.c = c * scale;
  return modelledNoise(store, error, constants, threads);
}

/** Sets lambda to a profile's mean and the profile to ratios of it. */
void
takeVariances(std::vector<float> variances, float least, CloudMeasures& measures)
{
  double sum = 0;
  for (const float variance : variances) sum += variance;
  const double mean = sum / static_cast<double>(variances.size());
  if (!(mean > 0)) return;
  for (float& variance : variances)
    variance = std::clamp(static_cast<float>(variance / mean), least, 1 / least);
  measures.lambda = mean;
  measures.noise_profile = std::move(variances);
}

/** The paper's T_MDL belongs to its lambda; the default penalty to the residual estimate. */
double
noiseVariance(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
              int threads, ResidualNoise& residual)
{
  const double diagonal = store.diagonal();
  if (params.lambda) return *params.lambda * diagonal * diagonal;
  return measuresResiduals(params) ? residual.level().variance
                                   : measurePaperNoise(store, constants, threads).variance;
}

/** How noise varies over the cloud, if the user or the data show that it does. */
void
measureProfile(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
               int threads, ResidualNoise& residual, CloudMeasures& measures)
{
  const bool shared = measures.correlation > 1;
  if (params.noise_model) {
    takeVariances(modelProfile(store, params, constants, threads), constants.least_ratio, measures);
  } else if (params.local_noise == false) {
    return;
  } else if (params.local_noise == true || (shared && measuresResiduals(params))) {
    measures.noise_profile = measureNoiseProfile(store, residual.level(), constants, threads);
  } else if (measuresResiduals(params) && residual.level().uneven) {
    measures.noise_profile = measureRaisedProfile(store, residual.level(), constants, threads);
  }
}

void
measureErrors(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
              int threads, CloudMeasures& measures, FitStatistics& stats)
{
  ResidualNoise residual(store, params, constants, threads, stats);
  if (!params.noise_model)
    measures.lambda = noiseVariance(store, params, constants, threads, residual);
  if (measuresResiduals(params)) measures.correlation = residual.level().dependence;
  if (params.noise_correlation) measures.correlation = *params.noise_correlation;
  measureProfile(store, params, constants, threads, residual, measures);
  measures.noise = measures.lambda;
  stats.noise.patches += measures.noise_profile.size();
  stats.noise.correlation = measures.correlation;
  stats.noise.varies = !measures.noise_profile.empty();
  if (!measuresResiduals(params)) return;
  stats.noise.error = residual.level().error;
  stats.noise.correlation = residual.level().correlation;
  stats.noise.correlation_error = residual.level().correlation_error;
  stats.noise.frames = residual.level().frames;
  stats.noise.line = residual.level().dependence > 1 ? residual.level().line : 0;
  stats.noise.step = residual.level().step / store.diagonal();
  stats.noise.neighbors = residual.level().neighbors;
  stats.noise.patch_radius = residual.level().patch_radius / store.diagonal();
}

/** What normals weigh as data: the error stated, or the one measured if it is their own. */
double
normalError(const PointStore& store, const FitParams& params, const NormalErrorConstants& constants,
            int threads, FitStatistics& stats)
{
  if (params.normal_error) return *params.normal_error;
  const NormalError measured = measureNormalError(store, constants, threads);
  stats.noise.normals_follow_points = !measured.independent(constants);
  return stats.noise.normals_follow_points ? 0 : measured.radians;
}

/** The cosine above which two normals belong together. */
float
minDot(const PointStore& store, const FitParams& params, const FitConstants& constants)
{
  if (params.sharp_features) return constants.preset.sharp_bound;
  if (!store.hasSides() || params.paper_mode) return 0.0f;
  return normalBound(store, constants.normal_bound);
}

}  // namespace

Result<CloudMeasures>
measureCloud(const PointStore& store, const FitParams& params, const FitConstants& constants,
             int threads, FitStatistics& stats)
{
  CloudMeasures measures;
  measures.min_dot = minDot(store, params, constants);
  measureErrors(store, params, constants.noise, threads, measures, stats);
  if (!params.normals_as_data) return measures;
  if (!store.hasNormals()) {
    return Error{ErrorCode::kBadInput,
                 "the points have no normals to take as data: give some, or leave it"};
  }
  measures.normal_error = stats.noise.normal_error =
      normalError(store, params, constants.normal_error, threads, stats);
  return measures;
}

}  // namespace pcl_slim::detail

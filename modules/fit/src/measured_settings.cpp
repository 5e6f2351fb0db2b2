// SPDX-License-Identifier: BSD-3-Clause
#include "measured_settings.h"

#include <algorithm>
#include <utility>

#include "ball/normal_error.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"

namespace pcl_slim::detail {

namespace {

/** Whether lambda is the residual estimate, rather than given or the paper's. */
bool
measuresResiduals(const FitParams& params)
{
  return !params.lambda && !params.paper_mode && !params.hasThreshold();
}

/** The noise level by the residual estimate, measured where something asks for it, and then once. */
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
      stats_.noise_patches += level_.patches;
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
               ? recognizeSharedNoise(store_, white, constants_, threads_)
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
takeVariances(std::vector<float> variances, FitSettings& settings)
{
  double sum = 0;
  for (const float variance : variances) sum += variance;
  const double mean = sum / static_cast<double>(variances.size());
  if (!(mean > 0)) return;
  const float least = settings.constants.noise.least_ratio;
  for (float& variance : variances)
    variance = std::clamp(static_cast<float>(variance / mean), least, 1 / least);
  settings.energy.lambda = mean;
  settings.noise_profile = std::move(variances);
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

/** How noise varies over the cloud, where the user or the data say that it does. */
void
measureProfile(const PointStore& store, const FitParams& params, int threads,
               ResidualNoise& residual, FitSettings& settings)
{
  const NoiseConstants& constants = settings.constants.noise;
  const bool shared = settings.energy.correlation > 1;
  if (params.noise_model) {
    takeVariances(modelProfile(store, params, constants, threads), settings);
  } else if (params.local_noise == false) {
    return;
  } else if (params.local_noise == true || (shared && measuresResiduals(params))) {
    settings.noise_profile = measureNoiseProfile(store, residual.level(), constants, threads);
  } else if (measuresResiduals(params) && residual.level().uneven) {
    settings.noise_profile = measureRaisedProfile(store, residual.level(), constants, threads);
  }
}

void
measureNoiseSettings(const PointStore& store, const FitParams& params, int threads,
                     FitSettings& settings, FitStatistics& stats)
{
  const NoiseConstants& constants = settings.constants.noise;
  ResidualNoise residual(store, params, constants, threads, stats);
  if (!params.noise_model)
    settings.energy.lambda = noiseVariance(store, params, constants, threads, residual);
  if (measuresResiduals(params)) settings.energy.correlation = residual.level().dependence;
  if (params.noise_correlation) settings.energy.correlation = *params.noise_correlation;
  measureProfile(store, params, threads, residual, settings);
  // The paper's lambda, which T goes with, holds the surface's bend too; the smallest balls follow
  // it.
  if (!params.hasThreshold() && !params.paper_mode) settings.noise = settings.energy.lambda;
  stats.noise_patches += settings.noise_profile.size();
  stats.noise_correlation = settings.energy.correlation;
  stats.noise_varies = !settings.noise_profile.empty();
  if (!measuresResiduals(params)) return;
  stats.noise_correlation = residual.level().correlation;
  stats.noise_line = residual.level().dependence > 1 ? residual.level().line : 0;
  stats.noise_step = residual.level().step / store.diagonal();
  stats.noise_neighbors = residual.level().neighbors;
  stats.noise_patch_radius = residual.level().patch_radius / store.diagonal();
}

/** What normals weigh as data: the error stated, or the one measured if it is their own. */
Error
measureNormalSettings(const PointStore& store, const FitParams& params, int threads,
                      FitSettings& settings, FitStatistics& stats)
{
  if (!params.normals_as_data) return {};
  if (!store.hasNormals()) {
    return {ErrorCode::kBadInput,
            "the points have no normals to take as data: give some, or leave it"};
  }
  settings.normal_error = params.normal_error.value_or(0);
  if (!params.normal_error) {
    const NormalErrorConstants& constants = settings.constants.normal_error;
    const NormalError measured = measureNormalError(store, constants, threads);
    const bool independent = measured.independent(constants);
    stats.normals_follow_points = !independent;
    if (independent) settings.normal_error = measured.radians;
  }
  stats.normal_error = settings.normal_error;
  return {};
}

}  // namespace

Error
measureSettings(const PointStore& store, const FitParams& params, int threads,
                FitSettings& settings, FitStatistics& stats)
{
  measureNoiseSettings(store, params, threads, settings, stats);
  return measureNormalSettings(store, params, threads, settings, stats);
}

}  // namespace pcl_slim::detail

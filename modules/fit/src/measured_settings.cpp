// SPDX-License-Identifier: BSD-3-Clause
#include "measured_settings.h"

#include "ball/normal_error.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"

namespace pcl_slim::detail {

namespace {

/** The noise level by the residual estimate, measured where something asks for it, and then once. */
class ResidualNoise {
 public:
  ResidualNoise(const PointStore& store, const NoiseConstants& constants, int threads,
                FitStatistics& stats)
      : store_(store), constants_(constants), threads_(threads), stats_(stats)
  {
  }

  const NoiseLevel& level()
  {
    if (!measured_) {
      level_ = measureNoise(store_, constants_, threads_);
      stats_.noise_patches += level_.patches;
    }
    measured_ = true;
    return level_;
  }

 private:
  const PointStore& store_;
  const NoiseConstants& constants_;
  int threads_;
  FitStatistics& stats_;
  NoiseLevel level_;
  bool measured_ = false;
};

/** The paper's T_MDL belongs to its lambda; the default penalty to the residual estimate. */
double
noiseVariance(const PointStore& store, const FitParams& params, const NoiseConstants& constants,
              int threads, ResidualNoise& residual)
{
  const double diagonal = store.diagonal();
  if (params.lambda > 0) return params.lambda * diagonal * diagonal;
  const bool paper = params.paper_mode || params.t_mdl > 0;
  return paper ? measurePaperNoise(store, constants, threads).variance : residual.level().variance;
}

void
measureNoiseSettings(const PointStore& store, const FitParams& params, int threads,
                     FitSettings& settings, FitStatistics& stats)
{
  const NoiseConstants& constants = settings.constants.noise;
  ResidualNoise residual(store, constants, threads, stats);
  settings.energy.lambda = noiseVariance(store, params, constants, threads, residual);
  // The paper's lambda, which T goes with, holds the surface's bend too; the smallest balls follow
  // it.
  if (params.t_mdl <= 0 && !params.paper_mode) settings.noise = settings.energy.lambda;
  if (!params.local_noise) return;
  settings.noise_profile = measureNoiseProfile(store, residual.level(), constants, threads);
  stats.noise_patches += settings.noise_profile.size();
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
  settings.normal_error = params.normal_error;
  if (params.normal_error == 0) {
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

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/fit/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ball/normal_error.h"
#include "cover/level_cover.h"
#include "cover/start_level.h"
#include "orient/orientation.h"
#include "pcl_slim/cloud/detail/normal_bound.h"
#include "pcl_slim/cloud/noise_level.h"
#include "pcl_slim/core/parallel.h"
#include "penalty_search.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr float kSharpDot = 0.5f;
constexpr double kMostNormalError = 1.5707963267948966;  ///< pi/2: normals that tell nothing
constexpr double kAlpha = 2.0 / 3.0;                     ///< the paper's
constexpr double kAlphaWellSupported = 0.55;
constexpr double kLackOfFitForT = 10.0;  ///< beyond it a leaf swallows what T was not meant for

class Stopwatch {
 public:
  double lap()
  {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

FitSettings
makeSettings(const PointStore& store, const FitParams& params)
{
  FitSettings s;
  s.degree = params.degree;
  s.alpha = s.supported_alpha = params.cover_radius > 0 ? params.cover_radius : kAlpha;
  s.gamma = params.cover_threshold;
  s.diagonal = store.diagonal();
  s.center_grid = store.centerGrid();
  s.with_normals = store.hasNormals();
  if (params.sharp_features) {
    s.min_dot = kSharpDot;
  } else if (s.with_normals && !params.paper_mode) {
    s.min_dot = normalBound(store);
  }
  s.split_sheets = !store.hasNormals() && !params.paper_mode;
  s.robust = params.robust;
  s.seed = params.seed;
  // Faces between edges are small: wider balls only hold more of other faces.
  if (params.sharp_features) s.start_share = 0.15;
  s.paper = params.paper_mode;
  if (params.paper_mode) {
    s.fit_kernel = s.wall_kernel = s.cover_kernel = WeightKernel::kGaussian;
    s.lack_of_fit = 0;
    s.find_detail = s.compare_nested = false;
    s.residual_gate = 0;
    s.skip_lone_normals = false;
    s.energy.corrected = false;
  }
  if (params.t_mdl > 0) {
    // T is the user's word on how fine to go: fewer reasons to stop above it.
    s.lenience = 1.0;
    s.lack_of_fit = params.paper_mode ? 0.0 : kLackOfFitForT;
    s.find_detail = s.compare_nested = false;
    s.energy.thick = 4.0;
  } else if (!params.paper_mode) {
    // Smooth parts under noise are served by balls two levels wider than the paper's first.
    s.first_radius /= kGolden * kGolden;
    const bool sized = params.target_error > 0 || params.max_surfels > 0;
    if (params.cover_radius == 0 && !sized) s.supported_alpha = kAlphaWellSupported;
  }
  return s;
}

/** The paper's T_MDL belongs to its lambda; the default penalty to the residual estimate. */
double
noiseVariance(const PointStore& store, const FitParams& params, int threads)
{
  const double diagonal = store.diagonal();
  if (params.lambda > 0) return params.lambda * diagonal * diagonal;
  const bool paper = params.paper_mode || params.t_mdl > 0;
  return estimateNoise(
      store, paper ? NoiseEstimator::kMinEigenvalue10 : NoiseEstimator::kCubicResidual, threads);
}

/** What normals weigh as data: the error stated, or the one measured if it is their own. */
Error
settleNormals(const PointStore& store, const FitParams& params, int threads, FitSettings& settings,
              FitStatistics& stats)
{
  if (!params.normals_as_data) return {};
  if (!store.hasNormals()) {
    return {ErrorCode::kBadInput,
            "the points have no normals to take as data: give some, or leave it"};
  }
  settings.normal_error = params.normal_error;
  if (params.normal_error == 0) {
    const NormalError measured = measureNormalError(store, threads);
    stats.normals_follow_points = !measured.independent();
    if (measured.independent()) settings.normal_error = measured.radians;
  }
  stats.normal_error = settings.normal_error;
  return {};
}

void
setSurfel(std::size_t i, const SurfelRecord& r, SLIMSurface& surface)
{
  surface.cx[i] = r.center[0];
  surface.cy[i] = r.center[1];
  surface.cz[i] = r.center[2];
  surface.nx[i] = r.normal[0];
  surface.ny[i] = r.normal[1];
  surface.nz[i] = r.normal[2];
  surface.radius[i] = r.radius;
  surface.error[i] = r.error;
  surface.confidence[i] = r.confidence;
  surface.degree[i] = r.degree;
  surface.level[i] = r.level;
  surface.flags[i] = r.flags;
  const auto stride = static_cast<std::size_t>(surface.stride());
  std::copy_n(r.c.begin(), stride,
              surface.coefficients.begin() + static_cast<std::ptrdiff_t>(i * stride));
}

void
fillSurface(const LevelCover& cover, int threads, SLIMSurface& surface)
{
  const std::vector<LevelCover::Piece> pieces = cover.pieces();
  if (pieces.empty()) return;
  const LevelCover::Piece& last = pieces.back();
  surface.resize(last.first + static_cast<std::size_t>(last.end - last.begin));
  parallelFor(pieces.size(), threads, 16, [&](std::size_t p, int) {
    std::size_t i = pieces[p].first;
    for (const SurfelRecord* r = pieces[p].begin; r != pieces[p].end; ++r)
      setSurfel(i++, *r, surface);
  });
}

SurfaceInfo
makeInfo(const PointStore& store, const FitParams& params, const FitSettings& settings)
{
  SurfaceInfo info;
  info.degree = params.degree;
  info.fit_kernel = settings.fit_kernel;
  info.blend_kernel = params.paper_mode ? WeightKernel::kGaussian : WeightKernel::kPower4;
  info.oriented = store.hasNormals();
  info.paper_mode = params.paper_mode;
  info.origin = store.origin();
  info.scale = store.scale();
  info.diagonal = store.diagonal();
  info.lambda = settings.energy.lambda / (store.diagonal() * store.diagonal());
  info.penalty = settings.energy.t_mdl > 0 ? 0.0 : settings.energy.kappa;
  info.t_mdl = settings.energy.t_mdl / store.diagonal();
  info.cover_radius = settings.alpha;
  info.cover_threshold = params.cover_threshold;
  info.num_points = store.size();
  return info;
}

void
countSurfels(const SLIMSurface& surface, FitStatistics& stats)
{
  double weight = 0, sum = 0;
  stats.leaves_per_level.assign(static_cast<std::size_t>(stats.last_level) + 1, 0);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    stats.reduced_degree += surface.degree[i] < surface.info.degree;
    if (!surface.isLeaf(i)) continue;
    ++stats.leaves;
    ++stats.leaves_per_level[surface.level[i]];
    stats.forced += (surface.flags[i] & kSurfelForced) != 0;
    weight += surface.confidence[i];
    sum += static_cast<double>(surface.confidence[i]) * surface.error[i] * surface.error[i];
  }
  stats.internals = surface.size() - stats.leaves;
  stats.rms_error = weight > 0 ? std::sqrt(sum / weight) / surface.info.diagonal : 0.0;
}

void
countPoints(const PointStore& store, const LevelCover& cover, FitStatistics& stats)
{
  const PointCounts counts = cover.countPoints();
  stats.uncovered = counts.uncovered;
  stats.unsupported = counts.unsupported;
  stats.skipped_normals = counts.lone_normals;
  stats.split_sheets = cover.counters().split_sheets;
  stats.gathered = cover.counters().gathered;
  stats.never_gathered =
      store.size() - std::min<std::uint64_t>(store.size(), cover.counters().tried);
  stats.fits = cover.numFits();
  stats.last_level = cover.lastLevel();
  stats.working_bytes = cover.peakBytes();
}

}  // namespace

Error
FitParams::validate() const
{
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (degree < 0 || degree > kMaxDegree) {
    return bad("the polynomial degree must be 1, 2, 3 or 4 (0: by the other parameters)");
  }
  if (!(penalty >= 0) || !std::isfinite(penalty)) {
    return bad("the penalty kappa must be positive (0: by the other parameters)");
  }
  if (!(t_mdl >= 0) || !std::isfinite(t_mdl)) return bad("T_MDL must be positive (0: unused)");
  if (!(target_error >= 0 && target_error < 1))
    return bad("the target error is a share of the diagonal: 0 to 1");
  if (!(lambda >= 0) || !std::isfinite(lambda)) return bad("lambda must not be negative");
  if (!(cover_radius >= 0 && cover_radius <= 1))
    return bad("the cover radius alpha must lie in (0, 1] (0: by the points behind a leaf)");
  if (!(cover_threshold > 0 && cover_threshold <= 1))
    return bad("the cover threshold gamma must lie in (0, 1]");
  if (target_error > 0 && max_surfels > 0)
    return bad("give a target error or a number of surfels, not both");
  if (t_mdl > 0 && (target_error > 0 || max_surfels > 0)) {
    return bad(
        "T_MDL is a penalty: a target error or number of surfels would replace it, give one");
  }
  if (!(normal_error >= 0 && normal_error <= kMostNormalError))
    return bad("the normals' error lies between 0 and pi/2 radians (0: measured)");
  if (normal_error > 0 && !normals_as_data)
    return bad("an error of normals matters where they are data: ask for that too, or leave it");
  if (normals_as_data && (t_mdl > 0 || paper_mode)) {
    return bad(
        "normals as data are weighed against the noise, which T_MDL and the paper's mode leave "
        "open: "
        "drop one");
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (has_viewpoint && !std::all_of(viewpoint, viewpoint + 3, finite)) {
    return bad("the viewpoint must be finite");
  }
  return {};
}

FitParams
FitParams::resolved() const
{
  FitParams settled = *this;
  if (degree == 0) settled.degree = sharp_features ? 2 : 4;
  if (penalty == 0) settled.penalty = sharp_features ? 1.0 : 3.0;
  return settled;
}

Error
fitSurface(const PointStore& store, const FitParams& asked, SLIMSurface& surface,
           FitStatistics* statistics, Progress* progress)
{
  surface.clear();
  if (Error error = asked.validate()) return error;
  const FitParams params = asked.resolved();
  if (store.size() == 0)
    return {ErrorCode::kBadInput, "the store holds no points: build it from some"};
  FitStatistics stats;
  const int threads = resolveThreads(params.threads);
  Stopwatch watch;

  FitSettings settings = makeSettings(store, params);
  settings.energy.lambda = noiseVariance(store, params, threads);
  // The paper's lambda, which T goes with, holds the surface's bend too; the smallest balls follow it.
  if (params.t_mdl <= 0 && !params.paper_mode) settings.noise = settings.energy.lambda;
  if (Error error = settleNormals(store, params, threads, settings, stats)) return error;
  if (params.local_noise) settings.noise_profile = noiseProfile(store, threads);
  settings.energy.kappa = params.penalty;
  settings.energy.t_mdl =
      (params.paper_mode && params.t_mdl <= 0 ? 0.01 : params.t_mdl) * store.diagonal();
  stats.seconds_noise = watch.lap();

  if (params.target_error > 0 || params.max_surfels > 0) {
    if (Error error = solvePenalty(store, params, settings, threads, progress)) return error;
  }
  stats.first_level = startLevel(store, settings);
  LevelCover cover(store, settings, threads);
  if (Error error = cover.run(stats.first_level, progress)) return error;
  stats.seconds_cover = watch.lap();

  surface.info = makeInfo(store, params, settings);
  fillSurface(cover, threads, surface);
  surface.buildLinks(threads);
  stats.seconds_links = watch.lap();
  if (!store.hasNormals() && params.orient) orientSurface(params, surface);
  stats.seconds_orient = watch.lap();

  stats.points = store.size();
  stats.threads = threads;
  stats.levels_skipped = stats.first_level - 1;
  stats.lambda = surface.info.lambda;
  stats.penalty = surface.info.penalty;
  stats.t_mdl = surface.info.t_mdl;
  countPoints(store, cover, stats);
  countSurfels(surface, stats);
  if (statistics != nullptr) *statistics = stats;
  return {};
}

}  // namespace pcl_slim

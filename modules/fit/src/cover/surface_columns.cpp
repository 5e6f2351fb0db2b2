// SPDX-License-Identifier: BSD-3-Clause
#include "fit_steps.h"

#include <algorithm>

#include "cover/level_cover.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kGrain = 16;  ///< pieces a thread takes at a time; no result depends on it

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
  surface.effective_count[i] = r.effective_count;
  surface.degree[i] = r.degree;
  surface.level[i] = r.level;
  surface.flags[i] = r.flags;
  const auto stride = static_cast<std::size_t>(surface.stride());
  std::copy_n(r.c.begin(), stride,
              surface.coefficients.begin() + static_cast<std::ptrdiff_t>(i * stride));
}

SurfaceInfo
makeInfo(const PointStore& store, const FitSettings& settings)
{
  SurfaceInfo info;
  info.degree = settings.degree;
  info.fit_kernel = settings.fit_kernel;
  info.blend_kernel = settings.paper ? WeightKernel::kGaussian : WeightKernel::kPower4;
  info.oriented = store.hasSides();
  info.sides_found = store.hasSides() && !store.hasNormals() && !store.hasSensors();
  info.paper_mode = settings.paper;
  info.origin = store.origin();
  info.scale = store.scale();
  info.diagonal = store.diagonal();
  const double diagonal = store.diagonal();
  const bool has_extent = diagonal > 0;  // of one place there is no share
  info.lambda = has_extent ? settings.energy.lambda / (diagonal * diagonal) : 0.0;
  info.penalty = settings.energy.t_mdl > 0 ? 0.0 : settings.energy.kappa;
  info.t_mdl = has_extent ? settings.energy.t_mdl / diagonal : 0.0;
  info.cover_radius = settings.alpha;
  info.cover_threshold = settings.gamma;
  info.num_points = store.size();
  return info;
}

}  // namespace

void
fillSurface(const PointStore& store, const FitSettings& settings, const LevelCover& cover,
            int threads, SLIMSurface& surface)
{
  surface.info = makeInfo(store, settings);
  const std::vector<LevelCover::Piece> pieces = cover.pieces();
  if (pieces.empty()) return;
  const LevelCover::Piece& last = pieces.back();
  surface.resize(last.first + static_cast<std::size_t>(last.end - last.begin));
  parallelFor(pieces.size(), threads, kGrain, [&](std::size_t p, int) {
    std::size_t i = pieces[p].first;
    for (const SurfelRecord* r = pieces[p].begin; r != pieces[p].end; ++r)
      setSurfel(i++, *r, surface);
  });
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/tile_rasterizer.h"

#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "tiles/surfel_bins.h"
#include "reference/tile_passes.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr int kMaxLayers = 8;        ///< how often a ray may pass through uncovered flaps
constexpr double kMaxShrink = 0.95;  ///< at the very rim a leaf has no weight to blend with

bool
frontOnly(const SLIMSurface& surface, const RenderParams& params)
{
  if (params.sides != VisibleSides::kAuto) return params.sides == VisibleSides::kFront;
  return surface.info.oriented && params.cuts.empty();
}

/** \brief Half spaces in a surface's local coordinates. */
std::vector<HalfSpace>
localCuts(const RenderParams& params, const SurfaceInfo& info)
{
  std::vector<HalfSpace> cuts = params.cuts;
  for (HalfSpace& cut : cuts) {
    cut.offset = (cut.offset - dot(cut.normal, info.origin)) / info.scale;
  }
  return cuts;
}

}  // namespace

Error
RenderParams::validate() const
{
  if (!(shrink >= 0.0 && shrink <= kMaxShrink)) {
    return {ErrorCode::kBadArgument, "the ball's shrink factor must be 0 (automatic) to 0.95"};
  }
  if (!std::isfinite(min_coverage)) {
    return {ErrorCode::kBadArgument, "the least coverage must be a finite number"};
  }
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return {ErrorCode::kBadArgument, "the near plane must be a finite distance, 0 or more"};
  }
  for (const HalfSpace& cut : cuts) {
    const double size = length(cut.normal);
    if (!(size > 0.0 && std::isfinite(size) && std::isfinite(cut.offset))) {
      return {ErrorCode::kBadArgument,
              "a half space needs a finite offset and a finite normal that is not 0"};
    }
  }
  return {};
}

RenderStatistics&
RenderStatistics::operator+=(const RenderStatistics& other)
{
  leaves += other.leaves;
  outside_frustum += other.outside_frustum;
  back_facing += other.back_facing;
  tile_entries += other.tile_entries;
  occluded_entries += other.occluded_entries;
  rays_first += other.rays_first;
  rays_blend += other.rays_blend;
  covered_pixels += other.covered_pixels;
  return *this;
}

Error
renderSurface(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
              GBuffer& buffer, RenderStatistics* statistics)
{
  buffer.resize(0, 0);
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (Error error = surface.validate()) return error;
  buffer.resize(camera.size.width, camera.size.height);

  const int threads = resolveThreads(params.threads);
  const double wanted = params.shrink > 0.0 ? params.shrink : surface.info.cover_radius;
  const double shrink = std::clamp(wanted, 0.05, kMaxShrink);
  const double near_plane = params.near_plane / surface.info.scale;
  const bool front_only = frontOnly(surface, params);
  RenderStatistics total;
  const CameraRays rays(camera, surface.info.origin, surface.info.scale);
  const SurfelBins bins = binLeaves(surface, rays, camera.size, shrink, near_plane,
                                    front_only && params.skip, threads, total);
  const double cover_radius = std::clamp(surface.info.cover_radius, 0.05, 1.0);
  const double min_coverage =
      params.min_coverage >= 0.0 ? params.min_coverage : surface.info.cover_threshold;
  const FrameContext frame{surface,      rays,       bins,       shrink,     cover_radius,
                           min_coverage, near_plane, front_only, params.skip,
                           localCuts(params, surface.info)};

  total += forEachTile<Tile, RenderStatistics>(
      bins, threads, [&](std::size_t t, Tile& tile, RenderStatistics& counts) {
        tile.begin(frame, camera.size, t);
        for (int layer = 0; layer < kMaxLayers; ++layer) {
          findFirstIntersections(frame, t, tile, counts);
          gatherBlends(frame, t, tile, counts);
          if (!peelUncovered(frame, tile)) break;
        }
        resolveTile(frame, tile, buffer, counts);
      });
  if (statistics) *statistics = total;
  return {};
}

}  // namespace pcl_slim

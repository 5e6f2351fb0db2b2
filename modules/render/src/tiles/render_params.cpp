// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/render_params.h"

#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "tiles/frame_rules.h"

namespace pcl_slim {

using detail::kMaxShrink;

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
  if (Error error = detail::checkHalfSpaces(cuts)) return error;
  if (!(lod >= 0.0 && lod <= 1024.0)) {
    return {ErrorCode::kBadArgument, "the level of detail must be 0 to 1024 pixels"};
  }
  if (reference && lod > 0.0) {
    return {ErrorCode::kBadArgument,
            "the reference rasteriser draws every leaf; set the level of detail to 0"};
  }
  return checkThreads(threads);
}

RenderStatistics&
RenderStatistics::operator+=(const RenderStatistics& other)
{
  leaves += other.leaves;
  outside_frustum += other.outside_frustum;
  outside_region += other.outside_region;
  back_facing += other.back_facing;
  below_detail += other.below_detail;
  coarse_surfels += other.coarse_surfels;
  tile_entries += other.tile_entries;
  occluded_entries += other.occluded_entries;
  rays_first += other.rays_first;
  rays_blend += other.rays_blend;
  rays_bracketed += other.rays_bracketed;
  covered_pixels += other.covered_pixels;
  closed_pixels += other.closed_pixels;
  return *this;
}

}  // namespace pcl_slim

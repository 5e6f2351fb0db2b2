// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/frame_rules.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"
#include "tiles/half_spaces.h"

namespace pcl_slim::detail {

FrameRules::FrameRules(const SurfaceInfo& info, const RenderParams& params)
    : shrink(std::clamp(params.shrink > 0.0 ? params.shrink : info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(info.cover_radius, 0.05, 1.0)),
      min_coverage(params.min_coverage >= 0.0 ? params.min_coverage : info.cover_threshold),
      near_plane(params.near_plane / info.scale),
      lod(params.lod),
      trim(params.trim),
      front_only(params.sides == VisibleSides::kFront ||
                 (params.sides == VisibleSides::kAuto && info.oriented && params.cuts.empty())),
      skip(params.skip),
      threads(resolveThreads(params.threads)),
      cuts(localHalfSpaces(params.cuts, info.origin, info.scale))
{
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/frame_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

Error
checkHalfSpaces(const std::vector<HalfSpace>& cuts)
{
  for (const HalfSpace& cut : cuts) {
    const double size = length(cut.normal);
    if (!(size > 0.0 && std::isfinite(size) && std::isfinite(cut.offset))) {
      return {ErrorCode::kBadArgument,
              "a half space needs a finite offset and a finite normal that is not 0"};
    }
  }
  return {};
}

std::vector<HalfSpace>
localHalfSpaces(std::vector<HalfSpace> cuts, const Vector3& origin, double scale)
{
  for (HalfSpace& cut : cuts) {
    const double size = length(cut.normal);
    cut.offset = (cut.offset - dot(cut.normal, origin)) / (size * scale);
    for (double& n : cut.normal) n /= size;
  }
  return cuts;
}

RayStretch
within(const std::vector<HalfSpace>& cuts, const Ray& ray, RayStretch stretch)
{
  for (const HalfSpace& cut : cuts) {
    const double inside = dot(cut.normal, ray.origin) - cut.offset;
    const double slope = dot(cut.normal, ray.direction);
    if (slope > 0.0) {
      stretch.near = std::max(stretch.near, -inside / slope);
    } else if (slope < 0.0) {
      stretch.far = std::min(stretch.far, -inside / slope);
    } else if (inside < 0.0) {
      stretch.far = -std::numeric_limits<double>::infinity();
    }
  }
  return stretch;
}

bool
isCutAway(const std::vector<HalfSpace>& cuts, const Vector3& center, double radius)
{
  return std::any_of(cuts.begin(), cuts.end(), [&](const HalfSpace& cut) {
    return dot(cut.normal, center) - cut.offset < -radius;
  });
}

FrameRules::FrameRules(const SurfaceInfo& info, const RenderParams& params)
    : shrink(std::clamp(params.shrink > 0.0 ? params.shrink : info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(info.cover_radius, 0.05, 1.0)),
      min_coverage(params.min_coverage >= 0.0 ? params.min_coverage : info.cover_threshold),
      near_plane(params.near_plane / info.scale),
      lod(params.lod),
      trim(params.trim),
      front_only(params.sides == VisibleSides::kFront ||
                 (params.sides == VisibleSides::kAuto && info.hasFront() && params.cuts.empty())),
      skip(params.skip),
      threads(resolveThreads(params.threads)),
      cuts(localHalfSpaces(params.cuts, info.origin, info.scale))
{
}

}  // namespace pcl_slim::detail

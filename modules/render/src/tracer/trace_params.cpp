// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/ray_tracer.h"
#include "tiles/frame_rules.h"

namespace pcl_slim {
namespace {

Error
bad(const char* message)
{
  return {ErrorCode::kBadArgument, message};
}

Error
checkLight(const RayLight& light)
{
  const double size = length(light.towards);
  if (!(std::isfinite(size) && size > 0.0)) {
    return bad("a light's direction must be finite and not 0");
  }
  if (!(light.spread >= 0.0 && light.spread <= 45.0)) {
    return bad("a light's radius must be 0 to 45 degrees");
  }
  for (const float channel : light.color) {
    if (!(channel >= 0.0f && std::isfinite(channel))) {
      return bad("a light's colour must be finite and not negative");
    }
  }
  return {};
}

}  // namespace

Error
TraceParams::validate() const
{
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return bad("the near plane must be a finite distance, 0 or more");
  }
  if (Error error = detail::checkHalfSpaces(cuts)) return error;
  if (!(depth_tolerance >= 0.0 && depth_tolerance <= 100.0)) {
    return bad("the depth tolerance must be 0 to 100 radii");
  }
  if (occlusion_rays < 0 || occlusion_rays > 4096) {
    return bad("the number of occlusion rays must be 0 to 4096");
  }
  if (!(occlusion_reach > 0.0 && std::isfinite(occlusion_reach))) {
    return bad("the reach of occlusion rays must be a positive number of diagonals");
  }
  if (lights.size() > 32) return bad("there may be no more than 32 lights");
  for (const RayLight& light : lights) {
    if (Error error = checkLight(light)) return error;
  }
  return {};
}

double
TraceStatistics::testedPerRay() const
{
  const std::uint64_t rays = rays_primary + rays_shadow + rays_occlusion;
  return rays > 0 ? static_cast<double>(tested_first + tested_blend) / static_cast<double>(rays)
                  : 0.0;
}

TraceStatistics&
TraceStatistics::operator+=(const TraceStatistics& other)
{
  leaves += other.leaves;
  rays_primary += other.rays_primary;
  rays_shadow += other.rays_shadow;
  rays_occlusion += other.rays_occlusion;
  nodes += other.nodes;
  tested_first += other.tested_first;
  tested_blend += other.tested_blend;
  bracketed += other.bracketed;
  closed += other.closed;
  peeled += other.peeled;
  covered_pixels += other.covered_pixels;
  return *this;
}

}  // namespace pcl_slim

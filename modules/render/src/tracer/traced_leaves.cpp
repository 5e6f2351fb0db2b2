// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <vector>

#include "reference/tile_passes.h"
#include "tracer/traced_object.h"

namespace pcl_slim::detail {
namespace {

bool
frontOnly(VisibleSides sides, bool oriented)
{
  return sides == VisibleSides::kFront || (sides == VisibleSides::kAuto && oriented);
}

class TracedLeaves : public TracedObject {
 public:
  TracedLeaves(const SLIMSurface& surface, int threads) : scene_(surface, threads)
  {
    origin = surface.info.origin;
    scale = surface.info.scale;
    diagonal = surface.info.diagonal;
    size = surface.numLeaves();
    rules_.min_coverage = surface.info.cover_threshold;
  }

  void trace(const TraceView& view, const BoundedRay* rays, std::size_t count, MetPoint* met,
             GBuffer* buffer, const std::size_t* pixels, RayCounts& counts) const override
  {
    RayRules rules = rules_;
    const bool closed = scene_.surface.info.hasFront() && view.params.cuts.empty();
    rules.front_only = frontOnly(view.params.sides, closed);
    rules.close_gaps = view.params.close_gaps;
    rules.with_hessian = buffer && (view.params.columns & (kHessianColumn | kCurvatureColumn)) != 0;
    std::vector<BlendedHit> hits(count);
    kernels::traceHits(scene_, rules, rays, count, hits.data(), counts);
    for (std::size_t i = 0; i < count; ++i) {
      met[i] = pointOf(hits[i]);
      if (!buffer || !met[i].met()) continue;
      writeBlend(scene_.surface, rays[i].ray, hits[i].depth_hat, hits[i].sum, pixels[i], *buffer);
      if (!buffer->residual.empty()) {
        buffer->residual[pixels[i]] = scene_.surface.error[met[i].id];
      }
    }
  }

  void block(const BoundedRay* rays, std::size_t count, bool close_gaps, std::uint8_t* blocked,
             RayCounts& counts) const override
  {
    RayRules rules = rules_;
    rules.close_gaps = close_gaps;
    kernels::traceBlocked(scene_, rules, rays, count, blocked, counts);
  }

  Departure departure(const MetPoint& point) const override
  {
    const double r = scene_.surface.radius[point.id], error = scene_.surface.error[point.id];
    // Leaves that blend at a point are apart by about their residuals, and by a small share of
    // their radii where the data are clean.
    const double lift = std::min(0.1 * r, 2.0 * error + 0.005 * r);
    if (!scene_.surface.info.hasFront()) return {lift, 0.0, 0.0, r};
    return point.back ? Departure{lift, r, 0.0, r} : Departure{lift, 0.0, r, r};
  }

 private:
  static MetPoint pointOf(const BlendedHit& hit)
  {
    MetPoint point;
    if (!hit.met()) return point;
    point.id = hit.sum.surfel;
    point.back = hit.sum.facing < 0;
    point.depth = hit.depth_hat + hit.sum.shift / hit.sum.weight;
    point.normal = normalized({hit.sum.gradient[0], hit.sum.gradient[1], hit.sum.gradient[2]});
    return point;
  }

  RayScene scene_;
  RayRules rules_;
};

}  // namespace

std::unique_ptr<TracedObject>
tracedLeaves(const SLIMSurface& surface, int threads)
{
  return std::make_unique<TracedLeaves>(surface, threads);
}

}  // namespace pcl_slim::detail

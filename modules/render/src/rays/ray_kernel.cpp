// SPDX-License-Identifier: BSD-3-Clause
// Rays through a surface's leaves, one at a time with eight leaves or boxes side by side.
#include <algorithm>
#include <limits>

#include "rays/ray_scene.h"
#include "tiles/frame_rules.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/ray_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "rays/blend_at-inl.h"
#include "rays/first_roots-inl.h"
#include "rays/tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {
namespace rays {

namespace hn = hwy::HWY_NAMESPACE;

/** A depth less a line's shift, rounded up. */
HWY_INLINE float
roundedUp(double depth)
{
  return static_cast<float>(depth + 2e-7 * std::abs(depth));
}

/** The first root of any leaf inside its ball of a share of its radius, from nearest to farthest;
 * infinity without one. Shares above the scene's own need the wider boxes. */
HWY_INLINE double
firstDepth(const BlendContext& context, const BoundedRay& ray, const Line& line, double nearest,
           double farthest, double share)
{
  const RayScene& scene = context.scene;
  const bool wide = share > scene.shrink;
  double best = farthest;
  bool met = false;
  float until = roundedUp(best - line.shift);
  const float from = static_cast<float>(std::max(0.0, nearest - line.shift - 1e-6));
  const auto meet = [&](std::uint32_t n, float* entry) HWY_ATTR {
    const WideBoxes& boxes = wide ? scene.tree.reach[n] : scene.tree.nodes[n].hit;
    return meetChildren(boxes, line, from, until, entry);
  };
  walkAlong(scene.tree, from, until, context.counts.nodes, meet, [&](std::uint32_t b) HWY_ATTR {
    const LocalRay local(ray, scene.blocks.head(b), nearest, best);
    for (std::size_t k = 0; k < kWide; k += hn::Lanes(Tag())) {
      LaneRoots roots;
      const auto shrink = static_cast<float>(share);
      if (!firstRootsOf(scene, b, k, local, shrink, context.counts, roots)) continue;
      const Vec depths = roots.s * roots.radius;
      const double depth = local.depth + GetLane(MinOfLanes(Tag(), depths));
      if (!(depth < best)) continue;
      best = depth;
      met = true;
      until = roundedUp(best - line.shift);
    }
    return true;
  });
  return met ? best : HUGE_VAL;
}

/** The blend at a depth of a ray. */
BlendSum
blendOn(const BlendContext& context, const BoundedRay& ray, double depth)
{
  const Ray& own = ray.ray;
  return blendAt(context,
                 {along(own.origin, depth, own.direction), own.direction, ray.nearest - depth});
}

/** Looks for a hit among first roots inside balls of a share of their radii, behind those whose blend
 * is refused too. \param[in] accept bool(sum) */
template <typename Accept>
HWY_INLINE void
traceLayers(const BlendContext& context, const BoundedRay& ray, const Line& line, double farthest,
            double share, const Accept& accept, BlendedHit& hit)
{
  double nearest = ray.nearest;
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    const double depth = firstDepth(context, ray, line, nearest, farthest, share);
    if (!(depth < HUGE_VAL)) return;
    const BlendSum sum = blendOn(context, ray, depth);
    if (sum.surfel == WideTree::kNothing) return;
    if (accept(sum)) {
      hit.depth_hat = depth;
      hit.sum = sum;
      return;
    }
    ++context.counts.peeled;
    nearest = depth + kPeelStep * double{context.scene.surface.radius[sum.surfel]};
  }
}

void
traceOne(const BlendContext& context, const BoundedRay& ray, BlendedHit& hit)
{
  hit = BlendedHit();
  const Line line(ray.ray, context.scene.tree.bounds);
  const double coverage = context.rules.min_coverage;
  traceLayers(
      context, ray, line, ray.farthest, context.scene.shrink,
      [&](const BlendSum& sum) { return isSupported(sum, coverage); }, hit);
  if (hit.met() || !context.rules.close_gaps) return;
  // Between shrunk balls a ray may slip through a sheet that continues all around it.
  traceLayers(
      context, ray, line, ray.farthest, kMaxShrink,
      [&](const BlendSum& sum) { return closesGap(sum, ray.ray.direction); }, hit);
  if (hit.met()) ++context.counts.closed;
}

/** Whether one of some lanes' roots is accepted.
 * \param[in] alone coverage by one leaf from which the blend need not be evaluated */
template <typename Accept>
HWY_INLINE bool
anyAccepted(const BlendContext& context, const BoundedRay& ray, double depth,
            const LaneRoots& roots, double alone, const Accept& accept)
{
  const Tag d;
  const RayScene& scene = context.scene;
  const unsigned met = bitsOf(roots.s < set(kNever));
  if (met == 0) return false;
  const float cover = static_cast<float>(1.0 / (scene.cover_radius * scene.cover_radius));
  const Vec own = kernelWeight(scene.surface.info.blend_kernel,
                               Min(roots.from_center_sq * set(cover), set(1.0f)));
  const Vec needed = set(static_cast<float>(alone));
  const bool trimmed = scene.surface.hasTrimMaps();
  if (!trimmed && (bitsOf(own >= needed) & met) != 0) return true;
  HWY_ALIGN float depths[kWide];
  Store(roots.s * roots.radius, d, depths);
  for (unsigned bits = met; bits != 0; bits &= bits - 1) {
    const double at = depth + depths[__builtin_ctz(bits)];
    if (accept(blendOn(context, ray, at))) return true;
    ++context.counts.peeled;
  }
  return false;
}

/** Whether any root inside balls of a share of their radii is accepted. */
template <typename Accept>
HWY_INLINE bool
anyRoot(const BlendContext& context, const BoundedRay& ray, const Line& line, double share,
        double alone, const Accept& accept)
{
  const RayScene& scene = context.scene;
  const bool wide = share > scene.shrink;
  const float until = roundedUp(ray.farthest - line.shift);
  const float from = static_cast<float>(std::max(0.0, ray.nearest - line.shift - 1e-6));
  bool found = false;
  const auto meet = [&](std::uint32_t n, float* entry) HWY_ATTR {
    const WideBoxes& boxes = wide ? scene.tree.reach[n] : scene.tree.nodes[n].hit;
    return meetChildren(boxes, line, from, until, entry);
  };
  walkAlong(scene.tree, from, until, context.counts.nodes, meet, [&](std::uint32_t b) HWY_ATTR {
    const LocalRay local(ray, scene.blocks.head(b), ray.nearest, ray.farthest);
    for (std::size_t k = 0; k < kWide && !found; k += hn::Lanes(Tag())) {
      LaneRoots roots;
      const auto shrink = static_cast<float>(share);
      if (!firstRootsOf(scene, b, k, local, shrink, context.counts, roots)) continue;
      found = anyAccepted(context, ray, local.depth, roots, alone, accept);
    }
    return !found;
  });
  return found;
}

bool
blockedOne(const BlendContext& context, const BoundedRay& ray)
{
  const Line line(ray.ray, context.scene.tree.bounds);
  const double coverage = context.rules.min_coverage;
  if (anyRoot(context, ray, line, context.scene.shrink, coverage,
              [&](const BlendSum& sum) { return isSupported(sum, coverage); })) {
    return true;
  }
  if (!context.rules.close_gaps) return false;
  BoundedRay beyond = ray;
  beyond.nearest = std::max(ray.nearest, ray.nearest_gap);
  return anyRoot(context, beyond, line, kMaxShrink, HUGE_VAL,
                 [&](const BlendSum& sum) { return closesGap(sum, ray.ray.direction); });
}

void
traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
          BlendedHit* hits, RayCounts& counts)
{
  const BlendContext context{scene, rules, counts};
  for (std::size_t i = 0; i < count; ++i) {
    BoundedRay ray = rays[i];
    if (rules.front_only) ray.nearest_behind = HUGE_VAL;
    traceOne(context, ray, hits[i]);
  }
}

void
traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
            double* depths, RayCounts& counts)
{
  const BlendContext context{scene, rules, counts};
  for (std::size_t i = 0; i < count; ++i) {
    BoundedRay ray = rays[i];
    if (rules.front_only) ray.nearest_behind = HUGE_VAL;
    const Line line(ray.ray, scene.tree.bounds);
    depths[i] = firstDepth(context, ray, line, ray.nearest, ray.farthest, scene.shrink);
  }
}

void
traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
             std::size_t count, std::uint8_t* blocked, RayCounts& counts)
{
  RayRules either = rules;
  either.front_only = false;
  either.with_hessian = false;
  const BlendContext context{scene, either, counts};
  for (std::size_t i = 0; i < count; ++i) blocked[i] = blockedOne(context, rays[i]) ? 1 : 0;
}

void
visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
            const BlockVisitor& visitor, std::uint64_t& nodes)
{
  const Line line(ray.ray, tree.bounds);
  float until = roundedUp(ray.farthest - line.shift);
  // A widened box may begin before the place where the line starts in single precision.
  const float from = static_cast<float>(ray.nearest - line.shift - 1e-6);
  const auto meet = [&](std::uint32_t n, float* entry) HWY_ATTR {
    return meetWidened(tree.nodes[n].hit, line, width, from, until, entry);
  };
  walkAlong(tree, from, until, nodes, meet, [&](std::uint32_t block) HWY_ATTR {
    double farthest = ray.farthest;
    const bool more = visitor.visit(visitor.context, block, farthest);
    until = std::min(until, roundedUp(farthest - line.shift));
    return more;
  });
}

}  // namespace rays

using rays::traceBlocked;
using rays::traceDepths;
using rays::traceHits;
using rays::visitBlocks;

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(traceHits);
HWY_EXPORT(traceDepths);
HWY_EXPORT(traceBlocked);
HWY_EXPORT(visitBlocks);

void
traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
          BlendedHit* hits, RayCounts& counts)
{
  if (scene.tree.empty()) {
    std::fill(hits, hits + count, BlendedHit());
    return;
  }
  HWY_DYNAMIC_DISPATCH(traceHits)(scene, rules, rays, count, hits, counts);
}

void
traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
            double* depths, RayCounts& counts)
{
  std::fill(depths, depths + count, HUGE_VAL);
  if (scene.tree.empty()) return;
  HWY_DYNAMIC_DISPATCH(traceDepths)(scene, rules, rays, count, depths, counts);
}

void
traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
             std::size_t count, std::uint8_t* blocked, RayCounts& counts)
{
  if (scene.tree.empty()) {
    std::fill(blocked, blocked + count, std::uint8_t{0});
    return;
  }
  HWY_DYNAMIC_DISPATCH(traceBlocked)(scene, rules, rays, count, blocked, counts);
}

void
visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
            const BlockVisitor& visitor, std::uint64_t& nodes)
{
  if (!tree.empty()) HWY_DYNAMIC_DISPATCH(visitBlocks)(tree, ray, width, visitor, nodes);
}

}  // namespace pcl_slim::detail::kernels
#endif

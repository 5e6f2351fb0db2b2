// SPDX-License-Identifier: BSD-3-Clause
// Rays through a surface's leaves, one at a time with eight leaves or boxes side by side.
#include <algorithm>
#include <limits>

#include "rays/ray_scene.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/ray_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "rays/blend_at-inl.h"
#include "rays/first_roots-inl.h"
#include "rays/tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kMaxLayers = 8;   ///< how often a ray may pass through uncovered flaps
constexpr double kStep = 0.05;  ///< of a leaf's radius: how far behind a flap the search goes on

/** A depth less a line's shift, rounded up. */
HWY_INLINE float
roundedUp(double depth)
{
  return static_cast<float>(depth + 2e-7 * std::abs(depth));
}

/** The first root of any leaf inside its shrunk ball, from nearest on; infinity without one. */
HWY_INLINE double
firstDepth(const BlendContext& context, const BoundedRay& ray, const Line& line, double nearest)
{
  const RayScene& scene = context.scene;
  double best = ray.farthest;
  bool met = false;
  float until = roundedUp(best - line.shift);
  const float from = static_cast<float>(std::max(0.0, nearest - line.shift - 1e-6));
  const auto meet = [&](const WideNode& node, float* entry)
                        HWY_ATTR { return meetChildren(node, line, from, until, entry); };
  walkAlong(scene.tree, from, until, context.counts.nodes, meet, [&](std::uint32_t b) HWY_ATTR {
    const LeafBlocks::Head& head = scene.blocks.head(b);
    const LocalRay local(ray, head, nearest, best);
    for (std::size_t k = 0; k < kWide; k += hn::Lanes(Lane())) {
      LaneRoots roots;
      const BlockLanes block{scene.blocks.columns(b), k};
      const auto shrink = static_cast<float>(scene.shrink);
      if (!firstRootsOf(head.degree, block, local, shrink, context.counts, roots)) continue;
      const Lanes depths = hn::Mul(roots.s, roots.radius);
      const double depth = local.depth + hn::GetLane(hn::MinOfLanes(Lane(), depths));
      if (!(depth < best)) continue;
      best = depth;
      met = true;
      until = roundedUp(best - line.shift);
    }
    return true;
  });
  return met ? best : HUGE_VAL;
}

void
traceOne(const BlendContext& context, const BoundedRay& ray, BlendedHit& hit)
{
  hit = BlendedHit();
  const Line line(ray.ray, context.scene.tree.bounds);
  double nearest = ray.nearest;
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    const double depth = firstDepth(context, ray, line, nearest);
    if (!(depth < HUGE_VAL)) return;
    const BlendPlace place{along(ray.ray.origin, depth, ray.ray.direction), ray.ray.direction,
                           ray.nearest - depth};
    const BlendSum sum = blendAt(context, place);
    if (sum.surfel == WideTree::kNothing) return;
    if (isSupported(sum, context.rules.min_coverage)) {
      hit.depth_hat = depth;
      hit.sum = sum;
      return;
    }
    ++context.counts.peeled;
    nearest = depth + kStep * double{context.scene.surface.radius[sum.surfel]};
  }
}

/** Whether one of some lanes' roots lies on the surface. What a leaf alone covers needs no blend. */
HWY_INLINE bool
anyOnSurface(const BlendContext& context, const BoundedRay& ray, double depth,
             const LaneRoots& roots)
{
  const Lane d;
  const RayScene& scene = context.scene;
  const unsigned met = bitsOf(hn::Lt(roots.s, all(kNever)));
  if (met == 0) return false;
  const float cover = static_cast<float>(1.0 / (scene.cover_radius * scene.cover_radius));
  const Lanes own = weightOf(scene.surface.info.blend_kernel,
                             hn::Min(hn::Mul(roots.from_center_sq, all(cover)), all(1.0f)));
  const Lanes needed = all(static_cast<float>(context.rules.min_coverage));
  const bool trimmed = scene.surface.hasTrimMaps();
  if (!trimmed && (bitsOf(hn::Ge(own, needed)) & met) != 0) return true;
  HWY_ALIGN float depths[kWide];
  hn::Store(hn::Mul(roots.s, roots.radius), d, depths);
  for (unsigned bits = met; bits != 0; bits &= bits - 1) {
    const double at = depth + depths[__builtin_ctz(bits)];
    const BlendPlace place{along(ray.ray.origin, at, ray.ray.direction), ray.ray.direction, -at};
    if (isSupported(blendAt(context, place), context.rules.min_coverage)) return true;
    ++context.counts.peeled;
  }
  return false;
}

bool
blockedOne(const BlendContext& context, const BoundedRay& ray)
{
  const RayScene& scene = context.scene;
  const Line line(ray.ray, scene.tree.bounds);
  const float until = roundedUp(ray.farthest - line.shift);
  const float from = static_cast<float>(std::max(0.0, ray.nearest - line.shift - 1e-6));
  bool blocked = false;
  const auto meet = [&](const WideNode& node, float* entry)
                        HWY_ATTR { return meetChildren(node, line, from, until, entry); };
  walkAlong(scene.tree, from, until, context.counts.nodes, meet, [&](std::uint32_t b) HWY_ATTR {
    const LeafBlocks::Head& head = scene.blocks.head(b);
    const LocalRay local(ray, head, ray.nearest, ray.farthest);
    for (std::size_t k = 0; k < kWide && !blocked; k += hn::Lanes(Lane())) {
      LaneRoots roots;
      const BlockLanes block{scene.blocks.columns(b), k};
      const auto shrink = static_cast<float>(scene.shrink);
      if (!firstRootsOf(head.degree, block, local, shrink, context.counts, roots)) continue;
      blocked = anyOnSurface(context, ray, local.depth, roots);
    }
    return !blocked;
  });
  return blocked;
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
    depths[i] = firstDepth(context, ray, Line(ray.ray, scene.tree.bounds), ray.nearest);
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
  const auto meet = [&](const WideNode& node, float* entry)
                        HWY_ATTR { return meetWidened(node, line, width, from, until, entry); };
  walkAlong(tree, from, until, nodes, meet, [&](std::uint32_t block) HWY_ATTR {
    double farthest = ray.farthest;
    const bool more = visitor.visit(visitor.context, block, farthest);
    until = std::min(until, roundedUp(farthest - line.shift));
    return more;
  });
}

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

// SPDX-License-Identifier: BSD-3-Clause
// Rays through a surface's leaves, one at a time with eight leaves or boxes side by side.
#include <algorithm>
#include <limits>

#include "rays/ray_scene.h"
#include "tiles/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/ray_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "rays/blend_at-inl.h"
#include "rays/leaf_lines-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {
namespace rays {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kNever = std::numeric_limits<float>::infinity();

/** A ray at a block: coordinates relative to the block, depths from the point next to its centre.
 */
struct LocalRay {
  double depth;  ///< of that point
  float point[3], direction[3];
  float front, behind, end;  ///< depths between which roots count, from either side

  LocalRay(const BoundedRay& bounded, const LeafBlocks::Head& head, double nearest,
           double end_depth) {
    const Ray& ray = bounded.ray;
    const Vector3 center{head.center[0], head.center[1], head.center[2]};
    const Vector3 to_center = subtract(center, ray.origin);
    depth = dot(to_center, ray.direction);
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = static_cast<float>(depth * ray.direction[a] - to_center[a]);
      direction[a] = static_cast<float>(ray.direction[a]);
    }
    front = static_cast<float>(std::max(nearest, bounded.nearest_front) - depth);
    behind = static_cast<float>(std::max(nearest, bounded.nearest_behind) - depth);
    end = static_cast<float>(end_depth - depth);
  }
};

/** The chords of a ray in the leaves' balls of a share of their radii, in radii from p on. */
struct LaneChords {
  Vec middle;  ///< where the ray comes closest to the centre
  Vec distance_sq, front, behind, high;
  Mask inside;

  LaneChords(const LocalRay& ray, Vec inverse_radius, const Triad& p, const Triad& d, float share) {
    const Vec zero = Zero(Tag());
    middle = Neg(dot3(p, d));
    const Triad closest = pointAt(p, middle, d);
    distance_sq = dot3(closest, closest);
    const Vec half_sq = set(share * share) - distance_sq;
    const Vec half = Sqrt(Max(half_sq, zero));
    const Vec low = middle - half;
    front = Max(low, set(ray.front) * inverse_radius);
    behind = Max(low, set(ray.behind) * inverse_radius);
    high = Min(middle + half, set(ray.end) * inverse_radius);
    inside = And(half_sq > zero, Min(front, behind) <= high);
  }
};

/** The trim maps of some lanes' leaves. */
struct LaneTrims {
  const SLIMSurface& surface;
  const std::uint32_t* surfels;

  bool hasData(std::size_t lane, double u, double v) const {
    return outsideShare(surface.trimMap(surfels[lane]), u, v) <= 0.5;
  }
};

/** Those of some lanes whose leaf's own trim map has data at s. */
template <int D>
HWY_INLINE Mask haveData(const LaneTrims& trims, const LeafLines<D>& line, Vec s, Mask some) {
  if (!trims.surface.hasTrimMaps()) return some;
  const Tag d;
  HWY_ALIGN float u[kWide], v[kWide], have[kWide] = {};
  Store(MulAdd(s, line.d.x, line.p.x), d, u);
  Store(MulAdd(s, line.d.y, line.p.y), d, v);
  for (unsigned bits = bitsOf(some); bits != 0; bits &= bits - 1) {
    const auto k = static_cast<std::size_t>(__builtin_ctz(bits));
    have[k] = trims.hasData(k, u[k], v[k]) ? 1.0f : 0.0f;
  }
  return Load(d, have) > Zero(d);
}

/** Roots of quadratic and linear leaves, in closed form without cancellation. */
HWY_INLINE Vec firstOfQuadratics(const LeafLines<2>& line, const LaneChords& chord,
                                 const LaneTrims& trims) {
  const QuadraticRoots<Vec> roots(line);
  const Mask real = And(chord.inside, roots.real);
  const auto counted = [&](Vec s, Mask falling) HWY_ATTR {
    const Vec low = IfThenElse(falling, chord.front, chord.behind);
    const Mask on_chord = And(real, And(s >= low, s <= chord.high));
    return IfThenElse(haveData(trims, line, s, on_chord), s, set(kNever));
  };
  return Min(counted(roots.one, roots.one_falls), counted(roots.other, Not(roots.one_falls)));
}

/** Roots of cubics and quartics, isolated one by one where there may be any. */
template <int D>
HWY_INLINE Vec firstOfHigher(const LeafLines<D>& line, const LaneChords& chord,
                             const LaneTrims& trims, std::uint64_t& bracketed) {
  const Tag d;
  const Vec low = Min(chord.front, chord.behind);
  unsigned bits = bitsOf(And(chord.inside, line.mayHaveRoots(low, chord.high)));
  if (bits == 0) return set(kNever);
  HWY_ALIGN float a[D + 1][kWide], front[kWide], behind[kWide], high[kWide], root[kWide];
  HWY_ALIGN float u[kWide], v[kWide], du[kWide], dv[kWide];
  Store(line.p.x, d, u);
  Store(line.p.y, d, v);
  Store(line.d.x, d, du);
  Store(line.d.y, d, dv);
  for (int i = 0; i <= D; ++i) Store(line.a[i], d, a[i]);
  Store(chord.front, d, front);
  Store(chord.behind, d, behind);
  Store(chord.high, d, high);
  Store(set(kNever), d, root);
  for (; bits != 0; bits &= bits - 1) {
    const auto k = static_cast<std::size_t>(__builtin_ctz(bits));
    double own[5] = {};
    for (int i = 0; i <= D; ++i) own[i] = a[i][k];
    ++bracketed;
    const auto counts = [&](double s) {
      return trims.hasData(k, u[k] + s * du[k], v[k] + s * dv[k]);
    };
    root[k] = static_cast<float>(firstRootInInterval(D, own, front[k], behind[k], high[k], counts));
  }
  return Load(d, root);
}

/** The hits of the leaves of some lanes. */
struct LaneRoots {
  Vec s;               ///< in radii from p on; infinity where there is none
  Vec radius;          ///< of the leaves
  Vec from_center_sq;  ///< squared distance of the root from the centre, in radii
};

/** First roots of leaves k, k + 1, ... of a block at which their trim maps have data. \return false
 * when there are none. */
template <int D>
HWY_INLINE bool firstRoots(const BlockLanes& block, const LaneTrims& trims, const LocalRay& ray,
                           float shrink, RayCounts& counts, LaneRoots& roots) {
  const Triad p = block.place(ray.point), direction = tripleOf<Vec>(ray.direction);
  const LaneChords chord(ray, block.column(kBlockInverseRadius), p, direction, shrink);
  const unsigned bits = bitsOf(chord.inside);
  if (bits == 0) return false;
  counts.leaves_first += static_cast<std::uint64_t>(__builtin_popcount(bits));
  const FrameLanes<Vec> frame = block.frames();
  const LeafLines<D> line(block, frame.turn(p), frame.turn(direction));
  if constexpr (D == 2)
    roots.s = firstOfQuadratics(line, chord, trims);
  else
    roots.s = firstOfHigher<D>(line, chord, trims, counts.bracketed);
  const Vec beyond = roots.s - chord.middle;
  roots.from_center_sq = MulAdd(beyond, beyond, chord.distance_sq);
  roots.radius = block.column(kBlockRadius);
  return true;
}

/** The same of lanes k, k + 1, ... of any block. */
HWY_INLINE bool firstRootsOf(const RayScene& scene, std::uint32_t b, std::size_t k,
                             const LocalRay& ray, float shrink, RayCounts& counts,
                             LaneRoots& roots) {
  const LeafBlocks::Head& head = scene.blocks.head(b);
  const BlockLanes block{scene.blocks.columns(b), k};
  const LaneTrims trims{scene.surface, head.surfel + k};
  switch (head.degree) {
    case 1:
    case 2: return firstRoots<2>(block, trims, ray, shrink, counts, roots);
    case 3: return firstRoots<3>(block, trims, ray, shrink, counts, roots);
    default: return firstRoots<4>(block, trims, ray, shrink, counts, roots);
  }
}

/** A depth less a line's shift, rounded up. */
HWY_INLINE float roundedUp(double depth) {
  return static_cast<float>(depth + 2e-7 * std::abs(depth));
}

/** The first root of any leaf inside its ball of a share of its radius, from nearest to farthest;
 * infinity without one. Shares above the scene's own need the wider boxes. */
HWY_INLINE double firstDepth(const BlendContext& context, const BoundedRay& ray, const Line& line,
                             double nearest, double farthest, double share) {
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
BlendSum blendOn(const BlendContext& context, const BoundedRay& ray, double depth) {
  const Ray& own = ray.ray;
  return blendAt(context,
                 {along(own.origin, depth, own.direction), own.direction, ray.nearest - depth});
}

/** Looks for a hit among first roots inside balls of a share of their radii, behind those whose
 * blend is refused too. \param[in] accept bool(sum) */
template <typename Accept>
HWY_INLINE void traceLayers(const BlendContext& context, const BoundedRay& ray, const Line& line,
                            double farthest, double share, const Accept& accept, BlendedHit& hit) {
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
    nearest = depth + peelStep(sum) * double{context.scene.surface.radius[sum.surfel]};
  }
}

/** Whether a ray does not pass above the surface, as far as that matters. */
bool isBelow(const RayRules& rules, const BlendSum& sum) {
  return rules.enclosed || !passesAbove(sum);
}

/** Whether a blend is on the surface. */
bool isOnSurface(const RayRules& rules, const BlendSum& sum) {
  return isSupported(sum, rules.min_coverage) && isBelow(rules, sum);
}

/** Whether a blend is on the surface between shrunk balls. */
bool isInGap(const RayRules& rules, const BlendSum& sum, const Ray& ray) {
  return closesGap(sum, ray.direction) && isBelow(rules, sum);
}

void traceOne(const BlendContext& context, const BoundedRay& ray, BlendedHit& hit) {
  hit = BlendedHit();
  const Line line(ray.ray, context.scene.tree.bounds);
  traceLayers(
      context, ray, line, ray.farthest, context.scene.shrink,
      [&](const BlendSum& sum) { return isOnSurface(context.rules, sum); }, hit);
  if (hit.met() || !context.rules.close_gaps) return;
  // Between shrunk balls a ray may slip through a sheet that continues all around it.
  traceLayers(
      context, ray, line, ray.farthest, kMaxShrink,
      [&](const BlendSum& sum) { return isInGap(context.rules, sum, ray.ray); }, hit);
  if (hit.met()) ++context.counts.closed;
}

/** Whether one of some lanes' roots is accepted.
 * \param[in] alone coverage by one leaf from which the blend need not be evaluated */
template <typename Accept>
HWY_INLINE bool anyAccepted(const BlendContext& context, const BoundedRay& ray, double depth,
                            const LaneRoots& roots, double alone, const Accept& accept) {
  const Tag d;
  const RayScene& scene = context.scene;
  const unsigned met = bitsOf(roots.s < set(kNever));
  if (met == 0) return false;
  const float cover = static_cast<float>(1.0 / (scene.cover_radius * scene.cover_radius));
  const Vec own = kernelWeight(scene.surface.info.blend_kernel,
                               Min(roots.from_center_sq * set(cover), set(1.0f)));
  const Vec needed = set(static_cast<float>(alone));
  const bool trimmed = scene.surface.hasTrimMaps();
  // Without a blend, not even whether the ray passes above it: that moves a shadow's edge by a hair.
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
HWY_INLINE bool anyRoot(const BlendContext& context, const BoundedRay& ray, const Line& line,
                        double share, double alone, const Accept& accept) {
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

bool blockedOne(const BlendContext& context, const BoundedRay& ray) {
  const Line line(ray.ray, context.scene.tree.bounds);
  const double coverage = context.rules.min_coverage;
  if (anyRoot(context, ray, line, context.scene.shrink, coverage,
              [&](const BlendSum& sum) { return isOnSurface(context.rules, sum); })) {
    return true;
  }
  if (!context.rules.close_gaps) return false;
  BoundedRay beyond = ray;
  beyond.nearest = std::max(ray.nearest, ray.nearest_gap);
  return anyRoot(context, beyond, line, kMaxShrink, HUGE_VAL,
                 [&](const BlendSum& sum) { return isInGap(context.rules, sum, ray.ray); });
}

void traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
               std::size_t count, BlendedHit* hits, RayCounts& counts) {
  const BlendContext context{scene, rules, counts};
  for (std::size_t i = 0; i < count; ++i) {
    BoundedRay ray = rays[i];
    if (rules.front_only) ray.nearest_behind = HUGE_VAL;
    traceOne(context, ray, hits[i]);
  }
}

void traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                 std::size_t count, double* depths, RayCounts& counts) {
  const BlendContext context{scene, rules, counts};
  for (std::size_t i = 0; i < count; ++i) {
    BoundedRay ray = rays[i];
    if (rules.front_only) ray.nearest_behind = HUGE_VAL;
    const Line line(ray.ray, scene.tree.bounds);
    depths[i] = firstDepth(context, ray, line, ray.nearest, ray.farthest, scene.shrink);
  }
}

void traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                  std::size_t count, std::uint8_t* blocked, RayCounts& counts) {
  RayRules either = rules;
  either.front_only = false;
  either.with_hessian = false;
  const BlendContext context{scene, either, counts};
  for (std::size_t i = 0; i < count; ++i) blocked[i] = blockedOne(context, rays[i]) ? 1 : 0;
}

void visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
                 const BlockVisitor& visitor, std::uint64_t& nodes) {
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

void traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
               std::size_t count, BlendedHit* hits, RayCounts& counts) {
  if (scene.tree.empty()) {
    std::fill(hits, hits + count, BlendedHit());
    return;
  }
  HWY_DYNAMIC_DISPATCH(traceHits)(scene, rules, rays, count, hits, counts);
}

void traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                 std::size_t count, double* depths, RayCounts& counts) {
  std::fill(depths, depths + count, HUGE_VAL);
  if (scene.tree.empty()) return;
  HWY_DYNAMIC_DISPATCH(traceDepths)(scene, rules, rays, count, depths, counts);
}

void traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                  std::size_t count, std::uint8_t* blocked, RayCounts& counts) {
  if (scene.tree.empty()) {
    std::fill(blocked, blocked + count, std::uint8_t{0});
    return;
  }
  HWY_DYNAMIC_DISPATCH(traceBlocked)(scene, rules, rays, count, blocked, counts);
}

void visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
                 const BlockVisitor& visitor, std::uint64_t& nodes) {
  if (!tree.empty()) HWY_DYNAMIC_DISPATCH(visitBlocks)(tree, ray, width, visitor, nodes);
}

}  // namespace pcl_slim::detail::kernels
#endif

// SPDX-License-Identifier: BSD-3-Clause
// The blend of the leaves around one point of a ray. The guard toggles: Highway compiles a kernel
// file once per instruction set.
#if defined(PCL_SLIM_BLEND_AT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLEND_AT_INL
#undef PCL_SLIM_BLEND_AT_INL
#else
#define PCL_SLIM_BLEND_AT_INL
#endif

#include "pcl_slim/leaf/detail/height-inl.h"
#include "pcl_slim/leaf/detail/roots.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "rays/leaf_lines-inl.h"
#include "rays/ray_scene.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays {

namespace hn = hwy::HWY_NAMESPACE;

/** The sums of a blend, each over the leaves of its lane. */
struct LaneSums {
  Vec weight, shift, coverage, leaves, facing, clearance;
  Vec gradient[3], hessian[6], offset_sum[3], spread[3];
  double outside = 0.0;  ///< of w outsideShare(), over all lanes
  HWY_ALIGN float largest[kWide];
  std::uint32_t surfel[kWide];

  LaneSums() {
    weight = shift = coverage = leaves = facing = clearance = Zero(Tag());
    for (auto& g : gradient) g = weight;
    for (auto& h : hessian) h = weight;
    for (auto& l : offset_sum) l = weight;
    for (auto& l : spread) l = weight;
    std::fill(largest, largest + kWide, 0.0f);
    std::fill(surfel, surfel + kWide, WideTree::kNothing);
  }

  /** The sums over all lanes. */
  BlendSum total() const {
    BlendSum sum;
    sum.weight = over(weight);
    sum.shift = over(shift);
    sum.coverage = over(coverage);
    sum.outside = outside;
    sum.clearance = over(clearance);
    sum.leaves = static_cast<int>(over(leaves));
    sum.facing = static_cast<std::int32_t>(over(facing));
    for (int a = 0; a < 3; ++a) {
      sum.gradient[a] = over(gradient[a]);
      sum.offset_sum[a] = over(offset_sum[a]);
      sum.spread[a] = over(spread[a]);
    }
    for (std::size_t i = 0; i < 6; ++i) sum.hessian[i] = over(hessian[i]);
    for (std::size_t k = 0; k < kWide; ++k) {
      if (!(largest[k] > sum.largest_weight)) continue;
      sum.largest_weight = largest[k];
      sum.surfel = surfel[k];
    }
    return sum;
  }

 private:
  static double over(Vec v) { return GetLane(SumOfLanes(Tag(), v)); }
};

/** What a blend is made at: q^ and the ray through it. */
struct BlendPlace {
  Vector3 point;  ///< q^
  Vector3 direction;
  double begin;  ///< nothing nearer than this counts, from q^ on along the ray: not positive
};

/** A blend's place relative to a block. */
struct LocalPlace {
  float point[3], direction[3];

  LocalPlace(const BlendPlace& place, const LeafBlocks::Head& head) {
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = static_cast<float>(place.point[a] - double{head.center[a]});
      direction[a] = static_cast<float>(place.direction[a]);
    }
  }
};

/** Roots within chords, from q^ on in radii. */
struct NearRoots {
  Vec s;
  Mask found;
};

HWY_INLINE NearRoots nearestOfQuadratics(const LeafLines<2>& line, Vec low, Vec high,
                                         bool front_only, Mask wanted) {
  const QuadraticRoots<Vec> roots(line);
  const Mask real = And(wanted, roots.real);
  const auto counts = [&](Vec s, Mask falling) HWY_ATTR {
    const Mask on_chord = And(real, And(s >= low, s <= high));
    return front_only ? And(on_chord, falling) : on_chord;
  };
  const Mask is_one = counts(roots.one, roots.one_falls);
  const Mask is_other = counts(roots.other, Not(roots.one_falls));
  const Mask nearer = And(is_other, Or(Not(is_one), Abs(roots.other) < Abs(roots.one)));
  return {IfThenElse(nearer, roots.other, roots.one), Or(is_one, is_other)};
}

template <int D>
HWY_INLINE NearRoots nearestOfHigher(const LeafLines<D>& line, Vec low, Vec high, bool front_only,
                                     Mask wanted, std::uint64_t& bracketed) {
  const Tag d;
  NearRoots roots{Neg(line.a[0] / line.a[1]), And(wanted, line.leadsToRoot())};
  for (int step = 0; step < 4; ++step) {
    roots.s -= line.value(roots.s) / line.slope(roots.s);
  }
  roots.found = And(roots.found, And(roots.s >= low, roots.s <= high));
  if (front_only) roots.found = And(roots.found, line.slope(roots.s) < Zero(d));
  unsigned bits = bitsOf(AndNot(roots.found, wanted));
  if (bits == 0) return roots;
  HWY_ALIGN float a[D + 1][kWide], from[kWide], to[kWide], s[kWide], is[kWide];
  for (int i = 0; i <= D; ++i) Store(line.a[i], d, a[i]);
  Store(low, d, from);
  Store(high, d, to);
  Store(roots.s, d, s);
  Store(IfThenElseZero(roots.found, set(1.0f)), d, is);
  for (; bits != 0; bits &= bits - 1) {
    const int k = __builtin_ctz(bits);
    double own[5] = {};
    for (int i = 0; i <= D; ++i) own[i] = a[i][k];
    ++bracketed;
    double root = s[k];
    is[k] = nearestRootInInterval(D, own, from[k], to[k], 0.0, front_only, root) ? 1.0f : 0.0f;
    s[k] = static_cast<float>(root);
  }
  return {Load(d, s), Load(d, is) > Zero(d)};
}

/** What blends need besides the block and the place. */
struct BlendContext {
  const RayScene& scene;
  const RayRules& rules;
  RayCounts& counts;
};

/** Adds w grad f and w H of some lanes, turned by the sign of w, in world axes. */
template <int D>
HWY_INLINE void addDerivatives(const BlockLanes& block, const FrameLanes<Vec>& frame, Vec u, Vec v,
                               Vec weight, bool with_hessian, LaneSums& sums) {
  const Vec fu[3] = {frame.u.x, frame.u.y, frame.u.z}, fv[3] = {frame.v.x, frame.v.y, frame.v.z},
            fw[3] = {frame.w.x, frame.w.y, frame.w.z};
  Vec gradient[3];
  gradientIn(fu, fv, fw, slopesOf<D>(block, u, v), gradient);
  for (int a = 0; a < 3; ++a) sums.gradient[a] = MulAdd(weight, gradient[a], sums.gradient[a]);
  if (!with_hessian) return;
  const Vec scale = Neg(weight * block.column(kBlockInverseRadius));
  Vec hessian[6];
  hessianIn(fu, fv, secondDerivatives<D>(block, u, v), hessian);
  for (int k = 0; k < 6; ++k) sums.hessian[k] = MulAdd(scale, hessian[k], sums.hessian[k]);
}

/** Remembers the surfel of the largest weight of each lane. */
HWY_INLINE void keepLargest(const LeafBlocks::Head& head, std::size_t k, Vec weight,
                            LaneSums& sums) {
  const Tag d;
  const Vec largest = Load(d, sums.largest + k);
  const Mask more = weight > largest;
  Store(IfThenElse(more, weight, largest), d, sums.largest + k);
  for (unsigned bits = bitsOf(more); bits != 0; bits &= bits - 1) {
    const std::size_t lane = k + static_cast<std::size_t>(__builtin_ctz(bits));
    sums.surfel[lane] = head.surfel[lane];
  }
}

/** Adds the trim maps' values of open leaves at their crossings at (u, v). */
HWY_NOINLINE void addOutside(const SLIMSurface& surface, const std::uint32_t* surfels, Vec weight,
                             Vec u, Vec v, LaneSums& sums) {
  const Tag d;
  HWY_ALIGN float w[kWide], at_u[kWide], at_v[kWide];
  Store(weight, d, w);
  Store(u, d, at_u);
  Store(v, d, at_v);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (!(w[k] > 0.0f)) continue;
    sums.outside += w[k] * outsideShare(surface.trimMap(surfels[k]), at_u[k], at_v[k]);
  }
}

/** Adds where leaves meet the ray, from their centres: weighted, and as they are. */
HWY_INLINE void addPlaces(const Triad& at, Vec weight, Mask added, LaneSums& sums) {
  const Vec places[] = {at.x, at.y, at.z};
  for (std::size_t a = 0; a < 3; ++a) {
    sums.offset_sum[a] = MulAdd(weight, places[a], sums.offset_sum[a]);
    sums.spread[a] += IfThenElseZero(added, places[a]);
  }
}

/** Adds the heights of leaves that a ray misses next to q^, see heightBehind(). */
HWY_INLINE void addMissed(Vec at_hat, Vec behind, Vec weight, Mask missed, LaneSums& sums) {
  const Mask above = And(missed, at_hat > Zero(Tag()));
  sums.clearance += IfThenElseZero(above, weight * behind);
}

/** Adds leaves k, k + 1, ... of a block to a blend, as blendLeaf(). */
template <int D>
HWY_INLINE void addLeaves(const BlendContext& context, const LeafBlocks::Head& head,
                          const BlockLanes& block, const LocalPlace& place, double begin,
                          LaneSums& sums) {
  const Tag d;
  const Vec zero = Zero(d), one = set(1.0f);
  const Triad p = block.place(place.point), direction = tripleOf<Vec>(place.direction);
  const Vec hat_sq = dot3(p, p);
  Mask counts = hat_sq < one;
  const unsigned bits = bitsOf(counts);
  if (bits == 0) return;
  context.counts.leaves_blend += static_cast<std::uint64_t>(__builtin_popcount(bits));
  const FrameLanes<Vec> frame = block.frames();
  const LeafLines<D> line(block, frame.turn(p), frame.turn(direction));
  counts = And(counts, Abs(line.a[0]) < set(kMaxShift));
  if (AllFalse(d, counts)) return;

  const Vec b = dot3(p, direction);
  const Vec half = Sqrt(Max(zero, MulAdd(b, b, one - hat_sq)));
  const Vec high = half - b;
  const Vec low =
      Max(Neg(half + b), set(static_cast<float>(begin)) * block.column(kBlockInverseRadius));
  NearRoots roots;
  if constexpr (D == 2)
    roots = nearestOfQuadratics(line, low, high, context.rules.front_only, counts);
  else
    roots = nearestOfHigher<D>(line, low, high, context.rules.front_only, counts,
                               context.counts.bracketed);

  const WeightKernel kernel = context.scene.surface.info.blend_kernel;
  const Triad q = pointAt(p, roots.s, direction);
  const Vec root_sq = dot3(q, q);
  Vec weight = block.column(kBlockVariance) * kernelWeight(kernel, Max(hat_sq, root_sq));
  const Mask added = And(roots.found, weight > zero);
  const Vec behind = line.value(set(kBehind)), radius = block.column(kBlockRadius);
  addMissed(line.a[0], behind, block.column(kBlockVariance) * kernelWeight(kernel, hat_sq) * radius,
            AndNot(roots.found, counts), sums);
  if (AllFalse(d, added)) return;
  // A lane without a root may contain anything, infinity too, and no product with 0 mends that.
  const auto only = [added](Vec x) HWY_ATTR { return IfThenElseZero(added, x); };
  weight = only(weight);
  const Vec s = only(roots.s), u = only(line.p.x), v = only(line.p.y);
  const Vec cover =
      set(static_cast<float>(1.0 / (context.scene.cover_radius * context.scene.cover_radius)));
  sums.weight += weight;
  sums.shift = MulAdd(weight, s * radius, sums.shift);
  sums.coverage += only(kernelWeight(kernel, root_sq * cover));
  sums.leaves += only(one);
  const Mask rises = line.slope(s) > zero;
  const Vec side = IfThenElse(rises, Neg(one), one);
  sums.facing += only(side);
  sums.clearance = MulAdd(weight * radius, Min(only(side * behind), zero), sums.clearance);
  addPlaces(pointAt(p, s, direction), weight, added, sums);
  const Vec at_u = MulAdd(s, line.d.x, u), at_v = MulAdd(s, line.d.y, v);
  addDerivatives<D>(block, frame, at_u, at_v, side * weight, context.rules.with_hessian, sums);
  if (context.scene.surface.hasTrimMaps()) {
    addOutside(context.scene.surface, head.surfel + block.k, weight, at_u, at_v, sums);
  }
  keepLargest(head, block.k, weight, sums);
}

/** The blend of all leaves whose ball contains a place. */
HWY_INLINE BlendSum blendAt(const BlendContext& context, const BlendPlace& place) {
  const RayScene& scene = context.scene;
  LaneSums sums;
  const float point[3] = {static_cast<float>(place.point[0]), static_cast<float>(place.point[1]),
                          static_cast<float>(place.point[2])};
  walkAround(scene.tree, point, context.counts.nodes, [&](std::uint32_t b) HWY_ATTR {
    const LeafBlocks::Head& head = scene.blocks.head(b);
    const LocalPlace local(place, head);
    for (std::size_t k = 0; k < kWide; k += hn::Lanes(Tag())) {
      const BlockLanes block{scene.blocks.columns(b), k};
      switch (head.degree) {
        case 1:
        case 2: addLeaves<2>(context, head, block, local, place.begin, sums); break;
        case 3: addLeaves<3>(context, head, block, local, place.begin, sums); break;
        default: addLeaves<4>(context, head, block, local, place.begin, sums); break;
      }
    }
  });
  return sums.total();
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// The blend of the leaves around one point of a ray. The guard toggles: Highway compiles a kernel
// file once per instruction set.
#if defined(PCL_SLIM_BLEND_AT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLEND_AT_INL
#undef PCL_SLIM_BLEND_AT_INL
#else
#define PCL_SLIM_BLEND_AT_INL
#endif

#include "pcl_slim/query/detail/polynomial_roots.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "rays/leaf_lines-inl.h"
#include "rays/ray_scene.h"
#include "rays/tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** The sums of a blend, each over the leaves of its lane. */
struct LaneSums {
  Lanes weight, shift, coverage, leaves, facing;
  Lanes gradient[3], hessian[6], lean[3], spread[3];
  double outside = 0.0;  ///< of w outsideShare(), over all lanes
  HWY_ALIGN float largest[kWide];
  std::uint32_t surfel[kWide];

  LaneSums()
  {
    weight = shift = coverage = leaves = facing = hn::Zero(Lane());
    for (auto& g : gradient) g = weight;
    for (auto& h : hessian) h = weight;
    for (auto& l : lean) l = weight;
    for (auto& l : spread) l = weight;
    std::fill(largest, largest + kWide, 0.0f);
    std::fill(surfel, surfel + kWide, WideTree::kNothing);
  }

  /** The sums over all lanes. */
  BlendSum total() const
  {
    BlendSum sum;
    sum.weight = over(weight);
    sum.shift = over(shift);
    sum.coverage = over(coverage);
    sum.outside = outside;
    sum.leaves = static_cast<int>(over(leaves));
    sum.facing = static_cast<std::int32_t>(over(facing));
    for (int a = 0; a < 3; ++a) {
      sum.gradient[a] = over(gradient[a]);
      sum.lean[a] = over(lean[a]);
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
  static double over(Lanes v) { return hn::GetLane(hn::SumOfLanes(Lane(), v)); }
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

  LocalPlace(const BlendPlace& place, const LeafBlocks::Head& head)
  {
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = static_cast<float>(place.point[a] - double{head.center[a]});
      direction[a] = static_cast<float>(place.direction[a]);
    }
  }
};

/** Roots within chords, from q^ on in radii. */
struct NearRoots {
  Lanes s;
  Some found;
};

HWY_INLINE NearRoots
nearestOfQuadratics(const LeafLines<2>& line, Lanes low, Lanes high, bool front_only, Some wanted)
{
  const QuadraticRootLanes roots(line);
  const Some real = hn::And(wanted, roots.real);
  const auto counts = [&](Lanes s, Some falling) HWY_ATTR {
    const Some on_chord = hn::And(real, hn::And(hn::Ge(s, low), hn::Le(s, high)));
    return front_only ? hn::And(on_chord, falling) : on_chord;
  };
  const Some is_one = counts(roots.one, roots.one_falls);
  const Some is_other = counts(roots.other, hn::Not(roots.one_falls));
  const Some nearer =
      hn::And(is_other, hn::Or(hn::Not(is_one), hn::Lt(hn::Abs(roots.other), hn::Abs(roots.one))));
  return {hn::IfThenElse(nearer, roots.other, roots.one), hn::Or(is_one, is_other)};
}

/** Lanes where Newton's steps from q^ are sure to lead to the nearest root, as obviousRoot(). */
template <int D>
HWY_INLINE Some
obvious(const LeafLines<D>& line)
{
  const Lanes reach = hn::Mul(all(2.0f), hn::Abs(line.a[0])), steep = hn::Abs(line.a[1]);
  const Lanes m = hn::Div(reach, steep);
  const Lanes outer = hn::MulAdd(hn::Mul(all(12.0f), m), hn::Abs(line.a[4]),
                                 hn::Mul(all(6.0f), hn::Abs(line.a[3])));
  const Lanes bend = hn::MulAdd(m, outer, hn::Mul(all(2.0f), hn::Abs(line.a[2])));
  return hn::And(hn::Lt(reach, steep),
                 hn::Lt(hn::Mul(hn::Mul(all(2.0f), bend), reach), hn::Mul(steep, steep)));
}

template <int D>
HWY_INLINE NearRoots
nearestOfHigher(const LeafLines<D>& line, Lanes low, Lanes high, bool front_only, Some wanted,
                std::uint64_t& bracketed)
{
  const Lane d;
  NearRoots roots{hn::Neg(hn::Div(line.a[0], line.a[1])), hn::And(wanted, obvious<D>(line))};
  for (int step = 0; step < 4; ++step) {
    roots.s = hn::Sub(roots.s, hn::Div(line.value(roots.s), line.slope(roots.s)));
  }
  roots.found = hn::And(roots.found, hn::And(hn::Ge(roots.s, low), hn::Le(roots.s, high)));
  if (front_only) roots.found = hn::And(roots.found, hn::Lt(line.slope(roots.s), hn::Zero(d)));
  unsigned bits = bitsOf(hn::AndNot(roots.found, wanted));
  if (bits == 0) return roots;
  HWY_ALIGN float a[D + 1][kWide], from[kWide], to[kWide], s[kWide], is[kWide];
  for (int i = 0; i <= D; ++i) hn::Store(line.a[i], d, a[i]);
  hn::Store(low, d, from);
  hn::Store(high, d, to);
  hn::Store(roots.s, d, s);
  hn::Store(hn::IfThenElseZero(roots.found, all(1.0f)), d, is);
  for (; bits != 0; bits &= bits - 1) {
    const int k = __builtin_ctz(bits);
    double own[5] = {};
    for (int i = 0; i <= D; ++i) own[i] = a[i][k];
    ++bracketed;
    double root = s[k];
    is[k] = nearestRootInInterval(D, own, from[k], to[k], 0.0, front_only, root) ? 1.0f : 0.0f;
    s[k] = static_cast<float>(root);
  }
  return {hn::Load(d, s), hn::Gt(hn::Load(d, is), hn::Zero(d))};
}

/** What blends need besides the block and the place. */
struct BlendContext {
  const RayScene& scene;
  const RayRules& rules;
  RayCounts& counts;
};

/** Adds w grad f and w H of some lanes, turned by the sign of w, in world axes. */
template <int D>
HWY_INLINE void
addDerivatives(const BlockLanes& block, const FrameLanes<Lanes>& frame, Lanes u, Lanes v,
               Lanes weight, bool with_hessian, LaneSums& sums)
{
  const LaneJets<D> jet(block, u, v);
  const Lanes fu[3] = {frame.u.x, frame.u.y, frame.u.z}, fv[3] = {frame.v.x, frame.v.y, frame.v.z},
              fw[3] = {frame.w.x, frame.w.y, frame.w.z};
  for (int a = 0; a < 3; ++a) {
    const Lanes g = hn::NegMulAdd(jet.hu, fu[a], hn::NegMulAdd(jet.hv, fv[a], fw[a]));
    sums.gradient[a] = hn::MulAdd(weight, g, sums.gradient[a]);
  }
  if (!with_hessian) return;
  const Lanes scale = hn::Neg(hn::Mul(weight, block.column(kBlockInverseRadius)));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const Lanes mixed = hn::MulAdd(fu[i], fv[j], hn::Mul(fv[i], fu[j]));
      const Lanes entry =
          hn::MulAdd(hn::Mul(jet.huu, fu[i]), fu[j],
                     hn::MulAdd(jet.huv, mixed, hn::Mul(hn::Mul(jet.hvv, fv[i]), fv[j])));
      Lanes& sum = sums.hessian[kSymmetricEntry[i][j]];
      sum = hn::MulAdd(scale, entry, sum);
    }
  }
}

/** Remembers the surfel of the largest weight of each lane. */
HWY_INLINE void
keepLargest(const LeafBlocks::Head& head, std::size_t k, Lanes weight, LaneSums& sums)
{
  const Lane d;
  const Lanes largest = hn::Load(d, sums.largest + k);
  const Some more = hn::Gt(weight, largest);
  hn::Store(hn::IfThenElse(more, weight, largest), d, sums.largest + k);
  for (unsigned bits = bitsOf(more); bits != 0; bits &= bits - 1) {
    const std::size_t lane = k + static_cast<std::size_t>(__builtin_ctz(bits));
    sums.surfel[lane] = head.surfel[lane];
  }
}

/** Adds what the trim maps of open leaves say of their crossings at (u, v). */
HWY_NOINLINE void
addOutside(const SLIMSurface& surface, const std::uint32_t* surfels, Lanes weight, Lanes u, Lanes v,
           LaneSums& sums)
{
  const Lane d;
  HWY_ALIGN float w[kWide], at_u[kWide], at_v[kWide];
  hn::Store(weight, d, w);
  hn::Store(u, d, at_u);
  hn::Store(v, d, at_v);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (!(w[k] > 0.0f)) continue;
    sums.outside += w[k] * outsideShare(surface.trimMap(surfels[k]), at_u[k], at_v[k]);
  }
}

/** Adds where leaves meet the ray, from their centres: weighted, and as they are. */
HWY_INLINE void
addPlaces(const Triad& at, Lanes weight, Some added, LaneSums& sums)
{
  const Lanes places[] = {at.x, at.y, at.z};
  for (std::size_t a = 0; a < 3; ++a) {
    sums.lean[a] = hn::MulAdd(weight, places[a], sums.lean[a]);
    sums.spread[a] = hn::Add(sums.spread[a], hn::IfThenElseZero(added, places[a]));
  }
}

/** Adds leaves k, k + 1, ... of a block to a blend, as blendLeaf(). */
template <int D>
HWY_INLINE void
addLeaves(const BlendContext& context, const LeafBlocks::Head& head, const BlockLanes& block,
          const LocalPlace& place, double begin, LaneSums& sums)
{
  const Lane d;
  const Lanes zero = hn::Zero(d), one = all(1.0f);
  const Triad p = block.place(place.point), direction = tripleOf<Lanes>(place.direction);
  const Lanes hat_sq = dot3(p, p);
  Some counts = hn::Lt(hat_sq, one);
  const unsigned bits = bitsOf(counts);
  if (bits == 0) return;
  context.counts.leaves_blend += static_cast<std::uint64_t>(__builtin_popcount(bits));
  const FrameLanes<Lanes> frame = block.frames();
  const LeafLines<D> line(block, frame, p, direction);
  counts = hn::And(counts, hn::Lt(hn::Abs(line.a[0]), all(kMaxShift)));
  if (hn::AllFalse(d, counts)) return;

  const Lanes b = dot3(p, direction);
  const Lanes half = hn::Sqrt(hn::Max(zero, hn::MulAdd(b, b, hn::Sub(one, hat_sq))));
  const Lanes high = hn::Sub(half, b);
  const Lanes low = hn::Max(hn::Neg(hn::Add(half, b)), hn::Mul(all(static_cast<float>(begin)),
                                                               block.column(kBlockInverseRadius)));
  NearRoots roots;
  if constexpr (D == 2)
    roots = nearestOfQuadratics(line, low, high, context.rules.front_only, counts);
  else
    roots = nearestOfHigher<D>(line, low, high, context.rules.front_only, counts,
                               context.counts.bracketed);

  const WeightKernel kernel = context.scene.surface.info.blend_kernel;
  const Triad q = pointAt(p, roots.s, direction);
  const Lanes root_sq = dot3(q, q);
  Lanes weight =
      hn::Mul(block.column(kBlockVariance), kernelWeight(kernel, hn::Max(hat_sq, root_sq)));
  const Some added = hn::And(roots.found, hn::Gt(weight, zero));
  if (hn::AllFalse(d, added)) return;
  // Lanes without a root may hold anything, infinity too, and no product with 0 mends that.
  const auto only = [added](Lanes x) HWY_ATTR { return hn::IfThenElseZero(added, x); };
  weight = only(weight);
  const Lanes s = only(roots.s), u = only(line.u), v = only(line.v);
  const Lanes cover =
      all(static_cast<float>(1.0 / (context.scene.cover_radius * context.scene.cover_radius)));
  sums.weight = hn::Add(sums.weight, weight);
  sums.shift = hn::MulAdd(weight, hn::Mul(s, block.column(kBlockRadius)), sums.shift);
  sums.coverage = hn::Add(sums.coverage, only(kernelWeight(kernel, hn::Mul(root_sq, cover))));
  sums.leaves = hn::Add(sums.leaves, only(one));
  const Some rises = hn::Gt(line.slope(s), zero);
  const Lanes side = hn::IfThenElse(rises, hn::Neg(one), one);
  sums.facing = hn::Add(sums.facing, only(side));
  addPlaces(pointAt(p, s, direction), weight, added, sums);
  const Lanes at_u = hn::MulAdd(s, line.du, u), at_v = hn::MulAdd(s, line.dv, v);
  addDerivatives<D>(block, frame, at_u, at_v, hn::Mul(side, weight), context.rules.with_hessian,
                    sums);
  if (context.scene.surface.hasTrimMaps()) {
    addOutside(context.scene.surface, head.surfel + block.k, weight, at_u, at_v, sums);
  }
  keepLargest(head, block.k, weight, sums);
}

/** The blend of all leaves whose ball holds a place. */
HWY_INLINE BlendSum
blendAt(const BlendContext& context, const BlendPlace& place)
{
  const RayScene& scene = context.scene;
  LaneSums sums;
  const float point[3] = {static_cast<float>(place.point[0]), static_cast<float>(place.point[1]),
                          static_cast<float>(place.point[2])};
  walkAround(scene.tree, point, context.counts.nodes, [&](std::uint32_t b) HWY_ATTR {
    const LeafBlocks::Head& head = scene.blocks.head(b);
    const LocalPlace local(place, head);
    for (std::size_t k = 0; k < kWide; k += hn::Lanes(Lane())) {
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

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

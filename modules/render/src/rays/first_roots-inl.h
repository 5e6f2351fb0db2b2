// SPDX-License-Identifier: BSD-3-Clause
// First roots of a block's leaves along a ray. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_FIRST_ROOTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_FIRST_ROOTS_INL
#undef PCL_SLIM_FIRST_ROOTS_INL
#else
#define PCL_SLIM_FIRST_ROOTS_INL
#endif

#include "pcl_slim/query/detail/polynomial_roots.h"
#include "rays/leaf_lines-inl.h"
#include "rays/ray_scene.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kNever = std::numeric_limits<float>::infinity();

/** A ray at a block: coordinates relative to the block, depths to the point beside its centre. */
struct LocalRay {
  double depth;  ///< of that point
  float point[3], direction[3];
  float front, behind, end;  ///< depths between which roots count, from either side

  LocalRay(const BoundedRay& bounded, const LeafBlocks::Head& head, double nearest,
           double end_depth)
  {
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
  Lanes middle;  ///< where the ray comes closest to the centre
  Lanes distance_sq, front, behind, high;
  Some inside;

  LaneChords(const LocalRay& ray, Lanes inverse_radius, const Triad& p, const Triad& d, float share)
  {
    const Lanes zero = hn::Zero(Lane());
    middle = hn::Neg(dot3(p, d));
    const Triad closest = pointAt(p, middle, d);
    distance_sq = dot3(closest, closest);
    const Lanes half_sq = hn::Sub(all(share * share), distance_sq);
    const Lanes half = hn::Sqrt(hn::Max(half_sq, zero));
    const Lanes low = hn::Sub(middle, half);
    front = hn::Max(low, hn::Mul(all(ray.front), inverse_radius));
    behind = hn::Max(low, hn::Mul(all(ray.behind), inverse_radius));
    high = hn::Min(hn::Add(middle, half), hn::Mul(all(ray.end), inverse_radius));
    inside = hn::And(hn::Gt(half_sq, zero), hn::Le(hn::Min(front, behind), high));
  }
};

/** The trim maps of some lanes' leaves. */
struct LaneTrims {
  const SLIMSurface& surface;
  const std::uint32_t* surfels;

  bool hasData(std::size_t lane, double u, double v) const
  {
    return outsideShare(surface.trimMap(surfels[lane]), u, v) <= 0.5;
  }
};

/** Those of some lanes whose leaf's own trim map has data at s. */
template <int D>
HWY_INLINE Some
haveData(const LaneTrims& trims, const LeafLines<D>& line, Lanes s, Some some)
{
  if (!trims.surface.hasTrimMaps()) return some;
  const Lane d;
  HWY_ALIGN float u[kWide], v[kWide], have[kWide] = {};
  hn::Store(hn::MulAdd(s, line.du, line.u), d, u);
  hn::Store(hn::MulAdd(s, line.dv, line.v), d, v);
  for (unsigned bits = bitsOf(some); bits != 0; bits &= bits - 1) {
    const auto k = static_cast<std::size_t>(__builtin_ctz(bits));
    have[k] = trims.hasData(k, u[k], v[k]) ? 1.0f : 0.0f;
  }
  return hn::Gt(hn::Load(d, have), hn::Zero(d));
}

/** Roots of quadratic and linear leaves, in closed form without cancellation. */
HWY_INLINE Lanes
firstOfQuadratics(const LeafLines<2>& line, const LaneChords& chord, const LaneTrims& trims)
{
  const QuadraticRootLanes roots(line);
  const Some real = hn::And(chord.inside, roots.real);
  const auto counted = [&](Lanes s, Some falling) HWY_ATTR {
    const Lanes low = hn::IfThenElse(falling, chord.front, chord.behind);
    const Some on_chord = hn::And(real, hn::And(hn::Ge(s, low), hn::Le(s, chord.high)));
    return hn::IfThenElse(haveData(trims, line, s, on_chord), s, all(kNever));
  };
  return hn::Min(counted(roots.one, roots.one_falls),
                 counted(roots.other, hn::Not(roots.one_falls)));
}

/** Lanes on whose chords a polynomial of degree 3 or 4 may have a root, by the signs of its
 * Bernstein coefficients. */
template <int D>
HWY_INLINE Some
mayHaveRoots(const LeafLines<D>& line, Lanes low, Lanes high)
{
  Lanes c[D + 1];
  for (int i = 0; i <= D; ++i) c[i] = line.a[i];
  for (int i = 0; i < D; ++i) {
    for (int j = D - 1; j >= i; --j) c[j] = hn::MulAdd(low, c[j + 1], c[j]);
  }
  const Lanes span = hn::Sub(high, low);
  Lanes power = span;
  for (int i = 1; i <= D; ++i) {
    c[i] = hn::Mul(c[i], power);
    power = hn::Mul(power, span);
  }
  Lanes least = c[0], most = c[0];
  const auto take = [&](Lanes b) HWY_ATTR {
    least = hn::Min(least, b);
    most = hn::Max(most, b);
  };
  const auto times = [](float f, Lanes x) HWY_ATTR { return hn::Mul(all(f), x); };
  if constexpr (D == 3) {
    take(hn::MulAdd(all(1.0f / 3.0f), c[1], c[0]));
    take(hn::MulAdd(all(1.0f / 3.0f), hn::Add(hn::Add(c[1], c[1]), c[2]), c[0]));
    take(hn::Add(hn::Add(c[0], c[1]), hn::Add(c[2], c[3])));
  } else {
    take(hn::MulAdd(all(0.25f), c[1], c[0]));
    take(hn::MulAdd(all(0.5f), c[1], hn::MulAdd(all(1.0f / 6.0f), c[2], c[0])));
    take(hn::Add(hn::MulAdd(all(0.75f), c[1], c[0]),
                 hn::MulAdd(all(0.5f), c[2], times(0.25f, c[3]))));
    take(hn::Add(hn::Add(c[0], c[1]), hn::Add(c[2], hn::Add(c[3], c[4]))));
  }
  // A few roundings of room: a root at the very end of the chord is to be found as well.
  const Lanes room = all(1e-6f);
  return hn::And(hn::Le(least, room), hn::Ge(most, hn::Neg(room)));
}

/** Roots of cubics and quartics, isolated one by one where there may be any. */
template <int D>
HWY_INLINE Lanes
firstOfHigher(const LeafLines<D>& line, const LaneChords& chord, const LaneTrims& trims,
              std::uint64_t& bracketed)
{
  const Lane d;
  const Lanes low = hn::Min(chord.front, chord.behind);
  unsigned bits = bitsOf(hn::And(chord.inside, mayHaveRoots<D>(line, low, chord.high)));
  if (bits == 0) return all(kNever);
  HWY_ALIGN float a[D + 1][kWide], front[kWide], behind[kWide], high[kWide], root[kWide];
  HWY_ALIGN float u[kWide], v[kWide], du[kWide], dv[kWide];
  hn::Store(line.u, d, u);
  hn::Store(line.v, d, v);
  hn::Store(line.du, d, du);
  hn::Store(line.dv, d, dv);
  for (int i = 0; i <= D; ++i) hn::Store(line.a[i], d, a[i]);
  hn::Store(chord.front, d, front);
  hn::Store(chord.behind, d, behind);
  hn::Store(chord.high, d, high);
  hn::Store(all(kNever), d, root);
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
  return hn::Load(d, root);
}

/** What the leaves of some lanes are met at. */
struct LaneRoots {
  Lanes s;               ///< in radii from p on; infinity where there is none
  Lanes radius;          ///< of the leaves
  Lanes from_center_sq;  ///< squared distance of the root from the centre, in radii
};

/** First roots of leaves k, k + 1, ... of a block at which their trim maps have data. \return false
 * when there are none. */
template <int D>
HWY_INLINE bool
firstRoots(const BlockLanes& block, const LaneTrims& trims, const LocalRay& ray, float shrink,
           RayCounts& counts, LaneRoots& roots)
{
  const Triad p = block.place(ray.point), direction = tripleOf<Lanes>(ray.direction);
  const LaneChords chord(ray, block.column(kBlockInverseRadius), p, direction, shrink);
  const unsigned bits = bitsOf(chord.inside);
  if (bits == 0) return false;
  counts.leaves_first += static_cast<std::uint64_t>(__builtin_popcount(bits));
  const LeafLines<D> line(block, block.frames(), p, direction);
  if constexpr (D == 2)
    roots.s = firstOfQuadratics(line, chord, trims);
  else
    roots.s = firstOfHigher<D>(line, chord, trims, counts.bracketed);
  const Lanes beyond = hn::Sub(roots.s, chord.middle);
  roots.from_center_sq = hn::MulAdd(beyond, beyond, chord.distance_sq);
  roots.radius = block.column(kBlockRadius);
  return true;
}

/** The same of lanes k, k + 1, ... of any block. */
HWY_INLINE bool
firstRootsOf(const RayScene& scene, std::uint32_t b, std::size_t k, const LocalRay& ray,
             float shrink, RayCounts& counts, LaneRoots& roots)
{
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

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

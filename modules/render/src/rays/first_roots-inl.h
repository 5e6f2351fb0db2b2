// SPDX-License-Identifier: BSD-3-Clause
// First roots of a block's leaves along a ray. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_FIRST_ROOTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_FIRST_ROOTS_INL
#undef PCL_SLIM_FIRST_ROOTS_INL
#else
#define PCL_SLIM_FIRST_ROOTS_INL
#endif

#include "pcl_slim/query/detail/ray_surfel.h"
#include "rays/leaf_lines-inl.h"
#include "rays/ray_scene.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays {

constexpr float kNever = std::numeric_limits<float>::infinity();

/** A ray at a block: coordinates relative to the block, depths from the point next to its centre. */
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
  Vec middle;  ///< where the ray comes closest to the centre
  Vec distance_sq, front, behind, high;
  Mask inside;

  LaneChords(const LocalRay& ray, Vec inverse_radius, const Triad& p, const Triad& d, float share)
  {
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

  bool hasData(std::size_t lane, double u, double v) const
  {
    return outsideShare(surface.trimMap(surfels[lane]), u, v) <= 0.5;
  }
};

/** Those of some lanes whose leaf's own trim map has data at s. */
template <int D>
HWY_INLINE Mask
haveData(const LaneTrims& trims, const LeafLines<D>& line, Vec s, Mask some)
{
  if (!trims.surface.hasTrimMaps()) return some;
  const Tag d;
  HWY_ALIGN float u[kWide], v[kWide], have[kWide] = {};
  Store(MulAdd(s, line.du, line.u), d, u);
  Store(MulAdd(s, line.dv, line.v), d, v);
  for (unsigned bits = bitsOf(some); bits != 0; bits &= bits - 1) {
    const auto k = static_cast<std::size_t>(__builtin_ctz(bits));
    have[k] = trims.hasData(k, u[k], v[k]) ? 1.0f : 0.0f;
  }
  return Load(d, have) > Zero(d);
}

/** Roots of quadratic and linear leaves, in closed form without cancellation. */
HWY_INLINE Vec
firstOfQuadratics(const LeafLines<2>& line, const LaneChords& chord, const LaneTrims& trims)
{
  const QuadraticRootLanes roots(line);
  const Mask real = And(chord.inside, roots.real);
  const auto counted = [&](Vec s, Mask falling) HWY_ATTR {
    const Vec low = IfThenElse(falling, chord.front, chord.behind);
    const Mask on_chord = And(real, And(s >= low, s <= chord.high));
    return IfThenElse(haveData(trims, line, s, on_chord), s, set(kNever));
  };
  return Min(counted(roots.one, roots.one_falls), counted(roots.other, Not(roots.one_falls)));
}

/** Vec on whose chords a polynomial of degree 3 or 4 may have a root, by the signs of its
 * Bernstein coefficients. */
template <int D>
HWY_INLINE Mask
mayHaveRoots(const LeafLines<D>& line, Vec low, Vec high)
{
  Vec c[D + 1];
  for (int i = 0; i <= D; ++i) c[i] = line.a[i];
  for (int i = 0; i < D; ++i) {
    for (int j = D - 1; j >= i; --j) c[j] = MulAdd(low, c[j + 1], c[j]);
  }
  const Vec span = high - low;
  Vec power = span;
  for (int i = 1; i <= D; ++i) {
    c[i] *= power;
    power *= span;
  }
  Vec least = c[0], most = c[0];
  const auto take = [&](Vec b) HWY_ATTR {
    least = Min(least, b);
    most = Max(most, b);
  };
  const auto times = [](float f, Vec x) HWY_ATTR { return set(f) * x; };
  if constexpr (D == 3) {
    take(MulAdd(set(1.0f / 3.0f), c[1], c[0]));
    take(MulAdd(set(1.0f / 3.0f), c[1] + c[1] + c[2], c[0]));
    take(c[0] + c[1] + (c[2] + c[3]));
  } else {
    take(MulAdd(set(0.25f), c[1], c[0]));
    take(MulAdd(set(0.5f), c[1], MulAdd(set(1.0f / 6.0f), c[2], c[0])));
    take(MulAdd(set(0.75f), c[1], c[0]) + MulAdd(set(0.5f), c[2], times(0.25f, c[3])));
    take(c[0] + c[1] + (c[2] + (c[3] + c[4])));
  }
  // A few roundings of room: a root at the very end of the chord is to be found as well.
  const Vec room = set(1e-6f);
  return And(least <= room, most >= Neg(room));
}

/** Roots of cubics and quartics, isolated one by one where there may be any. */
template <int D>
HWY_INLINE Vec
firstOfHigher(const LeafLines<D>& line, const LaneChords& chord, const LaneTrims& trims,
              std::uint64_t& bracketed)
{
  const Tag d;
  const Vec low = Min(chord.front, chord.behind);
  unsigned bits = bitsOf(And(chord.inside, mayHaveRoots<D>(line, low, chord.high)));
  if (bits == 0) return set(kNever);
  HWY_ALIGN float a[D + 1][kWide], front[kWide], behind[kWide], high[kWide], root[kWide];
  HWY_ALIGN float u[kWide], v[kWide], du[kWide], dv[kWide];
  Store(line.u, d, u);
  Store(line.v, d, v);
  Store(line.du, d, du);
  Store(line.dv, d, dv);
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
HWY_INLINE bool
firstRoots(const BlockLanes& block, const LaneTrims& trims, const LocalRay& ray, float shrink,
           RayCounts& counts, LaneRoots& roots)
{
  const Triad p = block.place(ray.point), direction = tripleOf<Vec>(ray.direction);
  const LaneChords chord(ray, block.column(kBlockInverseRadius), p, direction, shrink);
  const unsigned bits = bitsOf(chord.inside);
  if (bits == 0) return false;
  counts.leaves_first += static_cast<std::uint64_t>(__builtin_popcount(bits));
  const LeafLines<D> line(block, block.frames(), p, direction);
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

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::rays
HWY_AFTER_NAMESPACE();
#endif

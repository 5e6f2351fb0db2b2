// SPDX-License-Identifier: BSD-3-Clause
#include "planes/planes.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planes/plane_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::plane_kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
using kernels::HWY_NAMESPACE::LanePacking;

void gatherSurroundings(const PointStore& store, std::size_t block,
                        const std::vector<std::uint32_t>& blocks, const float low[3],
                        const float high[3], BlockSurroundings& points) {
  const Floats d;
  const std::size_t room = (blocks.size() + 2) * PointStore::kBlock;
  if (points.x.size() < room)
    for (auto* column : {&points.x, &points.y, &points.z}) column->resize(2 * room);
  const float* columns[3] = {store.x(), store.y(), store.z()};
  const float* origins[3] = {store.blockOriginX(), store.blockOriginY(), store.blockOriginZ()};
  float* to[3] = {points.x.data(), points.y.data(), points.z.data()};
  std::size_t count = 0;
  for (const std::size_t b : blocks) {
    for (std::size_t i = b * PointStore::kBlock; i < (b + 1) * PointStore::kBlock;
         i += hn::Lanes(d)) {
      Vec places[3];
      Mask inside = MaskFromVec(BitCast(d, Set(hn::RebindToSigned<Floats>(), -1)));
      for (int a = 0; a < 3; ++a) {
        const float origin = origins[a][block];
        places[a] = Load(d, columns[a] + i) + Set(d, origins[a][b] - origin);
        inside = And(inside, And(places[a] >= Set(d, low[a] - origin),
                                 places[a] <= Set(d, high[a] - origin)));
      }
      const LanePacking<Floats> packing(d, inside);
      for (int a = 0; a < 3; ++a) packing.store(places[a], to[a] + count);
      count += packing.count();
    }
  }
  points.count = count;
}

/** Offsets of one neighbour from the points of all lanes. */
struct Offsets {
  Vec x, y, z, square;

  HWY_INLINE Offsets(const BlockSurroundings& points, std::size_t k, const Vec (&center)[3]) {
    const Floats d;
    x = Set(d, points.x[k]) - center[0];
    y = Set(d, points.y[k]) - center[1];
    z = Set(d, points.z[k]) - center[2];
    square = x * x + y * y + z * z;
  }
};

/** Squared radii, at most a limit, of balls with k points at the density of those that have some.
 */
HWY_INLINE Vec rescaled(const BlockSurroundings& points, const Vec (&center)[3], Vec reach_sq,
                        Vec k, Vec most_sq) {
  const Floats d;
  const auto one = Set(d, 1.0f);
  auto count = Zero(d);
  for (std::size_t m = 0; m < points.count; ++m) {
    const Offsets o(points, m, center);
    count += IfThenElseZero(o.square <= reach_sq, one);
  }
  return Min(most_sq, reach_sq * k / Max(count, one));
}

/** A covariance: its six entries in units of the ball's radius squared. */
struct Covariance {
  Vec xx, xy, xz, yy, yz, zz, count;

  HWY_INLINE Covariance(const BlockSurroundings& points, const Vec (&center)[3], Vec reach_sq) {
    const Floats d;
    const auto one = Set(d, 1.0f);
    auto x = Zero(d), y = Zero(d), z = Zero(d);
    xx = xy = xz = yy = yz = zz = count = Zero(d);
    for (std::size_t m = 0; m < points.count; ++m) {
      const Offsets o(points, m, center);
      const auto near = o.square <= reach_sq;
      const auto nx = IfThenElseZero(near, o.x), ny = IfThenElseZero(near, o.y),
                 nz = IfThenElseZero(near, o.z);
      count += IfThenElseZero(near, one);
      x += nx;
      y += ny;
      z += nz;
      xx += nx * nx;
      xy += nx * ny;
      xz += nx * nz;
      yy += ny * ny;
      yz += ny * nz;
      zz += nz * nz;
    }
    const auto each = one / Max(count, one);
    const auto unit = one / reach_sq;
    const auto central = [&](Vec sum, Vec a, Vec b)
                             HWY_ATTR { return unit * (sum * each - a * each * (b * each)); };
    xx = central(xx, x, x);
    xy = central(xy, x, y);
    xz = central(xz, x, z);
    yy = central(yy, y, y);
    yz = central(yz, y, z);
    zz = central(zz, z, z);
  }

  /** The least eigenvalue: Newton's steps from 0 rise to it. */
  HWY_INLINE Vec leastEigenvalue() const {
    constexpr int kSteps = 12;
    const Floats d;
    const auto product = [](Vec a, Vec b, Vec c) HWY_ATTR { return a * b * c; };
    const auto trace = xx + yy + zz;
    const auto minors = xx * yy + xx * zz + yy * zz - (xy * xy + xz * xz + yz * yz);
    const auto mixed = product(xy, xz, yz);
    const auto determinant = product(xx, yy, zz) + (mixed + mixed) -
                             (product(xx, yz, yz) + product(yy, xz, xz) + product(zz, xy, xy));
    auto root = Zero(d);
    for (int step = 0; step < kSteps; ++step) {
      const auto value = ((root - trace) * root + minors) * root - determinant;
      const auto slope = (Set(d, 3.0f) * root - (trace + trace)) * root + minors;
      const auto rises = slope > Set(d, 1e-7f);
      root = Max(root, root - IfThenElseZero(rises, value / slope));
    }
    return root;
  }
};

/** One vector in each lane. */
struct Vectors {
  Vec x, y, z;
};

HWY_INLINE Vectors crossed(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/** The longest cross product of two rows of C - root I, which is its null vector.
 * \param[out] square of its length */
HWY_INLINE Vectors nullVector(const Covariance& c, Vec root, Vec& square) {
  const Vectors rows[3] = {
      {c.xx - root, c.xy, c.xz}, {c.xy, c.yy - root, c.yz}, {c.xz, c.yz, c.zz - root}};
  Vectors longest = crossed(rows[0], rows[1]);
  const auto squareOf = [](const Vectors& v) HWY_ATTR { return v.x * v.x + v.y * v.y + v.z * v.z; };
  square = squareOf(longest);
  for (const int first : {0, 1}) {
    const Vectors other = crossed(rows[first], rows[2]);
    const auto other_square = squareOf(other);
    const auto longer = other_square > square;
    longest = {IfThenElse(longer, other.x, longest.x), IfThenElse(longer, other.y, longest.y),
               IfThenElse(longer, other.z, longest.z)};
    square = Max(square, other_square);
  }
  return longest;
}

/** Stores the lanes of some bits. */
HWY_INLINE void blend(Vec values, std::uint32_t lanes, float* to) {
  const Floats d;
  HWY_ALIGN float all[HWY_MAX_BYTES / 4];
  Store(values, d, all);
  for (; lanes != 0; lanes &= lanes - 1) to[__builtin_ctz(lanes)] = all[__builtin_ctz(lanes)];
}

void findPlanes(const PointStore& store, std::size_t block, const BlockSurroundings& points,
                std::uint32_t chosen, float reach, float most, float k, BlockPlanes& planes) {
  const Floats d;
  const auto wanted = Set(d, k), most_sq = Set(d, most * most);
  for (std::size_t lane = 0; lane < PointStore::kBlock; lane += hn::Lanes(d)) {
    const std::uint32_t ours = chosen >> lane & ((1u << hn::Lanes(d)) - 1);
    if (ours == 0) continue;
    const std::size_t i = block * PointStore::kBlock + lane;
    const Vec center[3] = {Load(d, store.x() + i), Load(d, store.y() + i), Load(d, store.z() + i)};
    const auto reach_sq = rescaled(points, center, Set(d, reach * reach), wanted, most_sq);
    const Covariance covariance(points, center, reach_sq);
    Vec square;
    const Vec least = covariance.leastEigenvalue();
    const Vectors n = nullVector(covariance, least, square);
    const auto unit = Set(d, 1.0f) / Sqrt(square);
    const auto enough = covariance.count >= wanted * Set(d, 0.6f);
    const auto few = covariance.count <= wanted * Set(d, 1.7f);
    std::uint8_t bits[8] = {};
    StoreMaskBits(d, And(And(enough, few), square > Set(d, 1e-12f)), bits);
    const std::uint32_t found = ours & (bits[0] | static_cast<std::uint32_t>(bits[1]) << 8);
    planes.found |= found << lane;
    blend(n.x * unit, found, planes.x.data() + lane);
    blend(n.y * unit, found, planes.y.data() + lane);
    blend(n.z * unit, found, planes.z.data() + lane);
    const auto trace = covariance.xx + covariance.yy + covariance.zz;
    blend(least / Max(trace, Set(d, 1e-12f)), found, planes.variation.data() + lane);
  }
}

}  // namespace pcl_slim::detail::plane_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::plane_kernels {

HWY_EXPORT(gatherSurroundings);
HWY_EXPORT(findPlanes);

void gatherSurroundings(const PointStore& store, std::size_t block,
                        const std::vector<std::uint32_t>& blocks, const float low[3],
                        const float high[3], BlockSurroundings& points) {
  HWY_DYNAMIC_DISPATCH(gatherSurroundings)(store, block, blocks, low, high, points);
}

void findPlanes(const PointStore& store, std::size_t block, const BlockSurroundings& points,
                std::uint32_t chosen, float reach, float most, float k, BlockPlanes& planes) {
  HWY_DYNAMIC_DISPATCH(findPlanes)(store, block, points, chosen, reach, most, k, planes);
}

}  // namespace pcl_slim::detail::plane_kernels
#endif

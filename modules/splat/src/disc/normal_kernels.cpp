// SPDX-License-Identifier: BSD-3-Clause
#include "disc/normal_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disc/normal_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"
#include "points/vector_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE {

using Vec = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
using kernels::HWY_NAMESPACE::LanePacking;

void
gatherSurroundings(const PointStore& store, std::size_t block,
                   const std::vector<std::uint32_t>& blocks, const float low[3],
                   const float high[3], BlockSurroundings& points)
{
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
      Mask inside = hn::MaskFromVec(hn::BitCast(d, hn::Set(hn::RebindToSigned<Floats>(), -1)));
      for (int a = 0; a < 3; ++a) {
        const float origin = origins[a][block];
        places[a] = hn::Add(hn::Load(d, columns[a] + i), hn::Set(d, origins[a][b] - origin));
        inside = hn::And(inside, hn::And(hn::Ge(places[a], hn::Set(d, low[a] - origin)),
                                         hn::Le(places[a], hn::Set(d, high[a] - origin))));
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

  HWY_INLINE Offsets(const BlockSurroundings& points, std::size_t k, const Vec (&center)[3])
  {
    const Floats d;
    x = hn::Sub(hn::Set(d, points.x[k]), center[0]);
    y = hn::Sub(hn::Set(d, points.y[k]), center[1]);
    z = hn::Sub(hn::Set(d, points.z[k]), center[2]);
    square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  }
};

/** Squared radii, at most a limit, of balls with k points at the density of those that have some. */
HWY_INLINE Vec
rescaled(const BlockSurroundings& points, const Vec (&center)[3], Vec reach_sq, Vec k, Vec most_sq)
{
  const Floats d;
  const auto one = hn::Set(d, 1.0f);
  auto count = hn::Zero(d);
  for (std::size_t m = 0; m < points.count; ++m) {
    const Offsets o(points, m, center);
    count = hn::Add(count, hn::IfThenElseZero(hn::Le(o.square, reach_sq), one));
  }
  return hn::Min(most_sq, hn::Div(hn::Mul(reach_sq, k), hn::Max(count, one)));
}

/** A covariance: its six entries in units of the ball's radius squared. */
struct Covariance {
  Vec xx, xy, xz, yy, yz, zz, count;

  HWY_INLINE Covariance(const BlockSurroundings& points, const Vec (&center)[3], Vec reach_sq)
  {
    const Floats d;
    const auto one = hn::Set(d, 1.0f);
    auto x = hn::Zero(d), y = hn::Zero(d), z = hn::Zero(d);
    xx = xy = xz = yy = yz = zz = count = hn::Zero(d);
    for (std::size_t m = 0; m < points.count; ++m) {
      const Offsets o(points, m, center);
      const auto near = hn::Le(o.square, reach_sq);
      const auto nx = hn::IfThenElseZero(near, o.x), ny = hn::IfThenElseZero(near, o.y),
                 nz = hn::IfThenElseZero(near, o.z);
      count = hn::Add(count, hn::IfThenElseZero(near, one));
      x = hn::Add(x, nx);
      y = hn::Add(y, ny);
      z = hn::Add(z, nz);
      xx = hn::Add(xx, hn::Mul(nx, nx));
      xy = hn::Add(xy, hn::Mul(nx, ny));
      xz = hn::Add(xz, hn::Mul(nx, nz));
      yy = hn::Add(yy, hn::Mul(ny, ny));
      yz = hn::Add(yz, hn::Mul(ny, nz));
      zz = hn::Add(zz, hn::Mul(nz, nz));
    }
    const auto each = hn::Div(one, hn::Max(count, one));
    const auto unit = hn::Div(one, reach_sq);
    const auto central = [&](Vec sum, Vec a, Vec b) HWY_ATTR {
      return hn::Mul(unit,
                     hn::Sub(hn::Mul(sum, each), hn::Mul(hn::Mul(a, each), hn::Mul(b, each))));
    };
    xx = central(xx, x, x);
    xy = central(xy, x, y);
    xz = central(xz, x, z);
    yy = central(yy, y, y);
    yz = central(yz, y, z);
    zz = central(zz, z, z);
  }

  /** The least eigenvalue: Newton's steps from 0 rise to it. */
  HWY_INLINE Vec leastEigenvalue() const
  {
    constexpr int kSteps = 12;
    const Floats d;
    const auto product = [](Vec a, Vec b, Vec c) HWY_ATTR { return hn::Mul(hn::Mul(a, b), c); };
    const auto trace = hn::Add(hn::Add(xx, yy), zz);
    const auto minors =
        hn::Sub(hn::Add(hn::Add(hn::Mul(xx, yy), hn::Mul(xx, zz)), hn::Mul(yy, zz)),
                hn::Add(hn::Add(hn::Mul(xy, xy), hn::Mul(xz, xz)), hn::Mul(yz, yz)));
    const auto mixed = product(xy, xz, yz);
    const auto determinant =
        hn::Sub(hn::Add(product(xx, yy, zz), hn::Add(mixed, mixed)),
                hn::Add(hn::Add(product(xx, yz, yz), product(yy, xz, xz)), product(zz, xy, xy)));
    auto root = hn::Zero(d);
    for (int step = 0; step < kSteps; ++step) {
      const auto value =
          hn::Sub(hn::Mul(hn::Add(hn::Mul(hn::Sub(root, trace), root), minors), root), determinant);
      const auto slope = hn::Add(
          hn::Mul(hn::Sub(hn::Mul(hn::Set(d, 3.0f), root), hn::Add(trace, trace)), root), minors);
      const auto rises = hn::Gt(slope, hn::Set(d, 1e-7f));
      root = hn::Max(root, hn::Sub(root, hn::IfThenElseZero(rises, hn::Div(value, slope))));
    }
    return root;
  }
};

/** One vector in each lane. */
struct Vectors {
  Vec x, y, z;
};

HWY_INLINE Vectors
crossed(const Vectors& a, const Vectors& b)
{
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/** The longest cross product of two rows of C - root I, which is its null vector.
 * \param[out] square of its length */
HWY_INLINE Vectors
nullVector(const Covariance& c, Vec root, Vec& square)
{
  const Vectors rows[3] = {{hn::Sub(c.xx, root), c.xy, c.xz},
                           {c.xy, hn::Sub(c.yy, root), c.yz},
                           {c.xz, c.yz, hn::Sub(c.zz, root)}};
  Vectors longest = crossed(rows[0], rows[1]);
  const auto squareOf = [](const Vectors& v) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(v.x, v.x), hn::Mul(v.y, v.y)), hn::Mul(v.z, v.z));
  };
  square = squareOf(longest);
  for (const int first : {0, 1}) {
    const Vectors other = crossed(rows[first], rows[2]);
    const auto other_square = squareOf(other);
    const auto longer = hn::Gt(other_square, square);
    longest = {hn::IfThenElse(longer, other.x, longest.x),
               hn::IfThenElse(longer, other.y, longest.y),
               hn::IfThenElse(longer, other.z, longest.z)};
    square = hn::Max(square, other_square);
  }
  return longest;
}

/** Stores the lanes of some bits. */
HWY_INLINE void
blend(Vec values, std::uint32_t lanes, float* to)
{
  const Floats d;
  HWY_ALIGN float all[HWY_MAX_BYTES / 4];
  hn::Store(values, d, all);
  for (; lanes != 0; lanes &= lanes - 1) to[__builtin_ctz(lanes)] = all[__builtin_ctz(lanes)];
}

void
findNormals(const PointStore& store, std::size_t block, const BlockSurroundings& points,
            std::uint32_t chosen, float reach, float most, float k, BlockNormals& normals)
{
  const Floats d;
  const auto wanted = hn::Set(d, k), most_sq = hn::Set(d, most * most);
  for (std::size_t lane = 0; lane < PointStore::kBlock; lane += hn::Lanes(d)) {
    const std::uint32_t ours = chosen >> lane & ((1u << hn::Lanes(d)) - 1);
    if (ours == 0) continue;
    const std::size_t i = block * PointStore::kBlock + lane;
    const Vec center[3] = {hn::Load(d, store.x() + i), hn::Load(d, store.y() + i),
                           hn::Load(d, store.z() + i)};
    const auto reach_sq = rescaled(points, center, hn::Set(d, reach * reach), wanted, most_sq);
    const Covariance covariance(points, center, reach_sq);
    Vec square;
    const Vectors n = nullVector(covariance, covariance.leastEigenvalue(), square);
    const auto unit = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(square));
    const auto enough = hn::Ge(covariance.count, hn::Mul(wanted, hn::Set(d, 0.6f)));
    const auto few = hn::Le(covariance.count, hn::Mul(wanted, hn::Set(d, 1.7f)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::And(hn::And(enough, few), hn::Gt(square, hn::Set(d, 1e-12f))), bits);
    const std::uint32_t found = ours & (bits[0] | static_cast<std::uint32_t>(bits[1]) << 8);
    normals.found |= found << lane;
    blend(hn::Mul(n.x, unit), found, normals.x.data() + lane);
    blend(hn::Mul(n.y, unit), found, normals.y.data() + lane);
    blend(hn::Mul(n.z, unit), found, normals.z.data() + lane);
  }
}

}  // namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::splat_kernels {

HWY_EXPORT(gatherSurroundings);
HWY_EXPORT(findNormals);

void
gatherSurroundings(const PointStore& store, std::size_t block,
                   const std::vector<std::uint32_t>& blocks, const float low[3],
                   const float high[3], BlockSurroundings& points)
{
  HWY_DYNAMIC_DISPATCH(gatherSurroundings)(store, block, blocks, low, high, points);
}

void
findNormals(const PointStore& store, std::size_t block, const BlockSurroundings& points,
            std::uint32_t chosen, float reach, float most, float k, BlockNormals& normals)
{
  HWY_DYNAMIC_DISPATCH(findNormals)(store, block, points, chosen, reach, most, k, normals);
}

}  // namespace pcl_slim::detail::splat_kernels
#endif

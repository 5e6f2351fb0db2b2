// SPDX-License-Identifier: BSD-3-Clause
// The loops over a point's neighbours, compiled for each instruction set.
#include <algorithm>
#include <cmath>

#include "trim/border_test.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/border_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
                   const Vector3& place, double reach, const PlaceSide& side, NearPoints& points) {
  const Tag d;
  const auto limit = set(static_cast<float>(reach * reach));
  const bool sided = side.min_dot > -1;
  points.reserve(blocks.size() * PointStore::kBlock);
  std::size_t count = 0;
  for (const std::size_t b : blocks) {
    const auto sx = set(static_cast<float>(store.blockOriginX()[b] - place[0]));
    const auto sy = set(static_cast<float>(store.blockOriginY()[b] - place[1]));
    const auto sz = set(static_cast<float>(store.blockOriginZ()[b] - place[2]));
    for (std::size_t i = b * PointStore::kBlock; i < (b + 1) * PointStore::kBlock;
         i += hn::Lanes(d)) {
      const auto dx = Load(d, store.x() + i) + sx;
      const auto dy = Load(d, store.y() + i) + sy;
      const auto dz = Load(d, store.z() + i) + sz;
      const auto distance_sq = dot3(dx, dy, dz, dx, dy, dz);
      const auto near = distance_sq <= limit;
      if (AllFalse(d, near)) continue;
      auto own = set(1.0f);
      if (sided) {
        const auto cosine =
            dot3(Load(d, store.nx() + i), Load(d, store.ny() + i), Load(d, store.nz() + i),
                 set(side.normal[0]), set(side.normal[1]), set(side.normal[2]));
        own = IfThenElseZero(cosine > set(side.min_dot), own);
      }
      const LanePacking packing(d, near);
      packing.store(dx, points.x.data() + count);
      packing.store(dy, points.y.data() + count);
      packing.store(dz, points.z.data() + count);
      packing.store(distance_sq, points.distance_sq.data() + count);
      packing.store(own, points.own.data() + count);
      count += packing.count();
    }
  }
  points.count = count;
  for (auto* column : {&points.x, &points.y, &points.z, &points.distance_sq, &points.own})
    std::fill_n(column->data() + count, PointStore::kBlock, 0.0f);
}

void findBlocked(const SweepPlane& plane, double reach, double least, NearPoints& points) {
  const Tag d;
  const auto axis = [&](std::size_t k, std::size_t a)
                        HWY_ATTR { return set(static_cast<float>(plane.axes[k][a])); };
  const auto ux = axis(0, 0), uy = axis(0, 1), uz = axis(0, 2);
  const auto vx = axis(1, 0), vy = axis(1, 1), vz = axis(1, 2);
  const auto wx = axis(2, 0), wy = axis(2, 1), wz = axis(2, 2);
  const auto height = set(static_cast<float>(plane.height));
  const auto window = set(static_cast<float>(plane.window));
  const auto cosine = set(static_cast<float>(std::cos(plane.turn)));
  const auto sine = set(static_cast<float>(std::sin(plane.turn)));
  const auto most_sq = set(static_cast<float>(reach * reach));
  const auto least_sq = set(static_cast<float>(least * least));
  const auto slope = set(static_cast<float>(plane.slope));
  const auto tip = set(static_cast<float>(plane.tip));
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {  // zeros, at the end, are too near
    const auto x = Load(d, points.x.data() + i), y = Load(d, points.y.data() + i),
               z = Load(d, points.z.data() + i);
    const auto u = dot3(x, y, z, ux, uy, uz), v = dot3(x, y, z, vx, vy, vz);
    const auto over = dot3(x, y, z, wx, wy, wz) - height;
    const auto w = CopySign(Max(Abs(over) - window, Zero(d)), over);
    const auto turned = MulAdd(u, cosine, w * sine);
    const auto flat_sq = MulAdd(turned, turned, v * v);
    const auto distance_sq = MulAdd(u, u, MulAdd(v, v, w * w));
    const auto own = Load(d, points.own.data() + i) > Zero(d);
    const auto of_sheet = Abs(w) <= slope * Sqrt(MulAdd(u, u, v * v));
    const auto at_tip = Sqrt(Load(d, points.distance_sq.data() + i)) <= tip;
    const auto counts =
        And(And(distance_sq <= most_sq, flat_sq >= least_sq), Or(own, Or(of_sheet, at_tip)));
    if (AllFalse(d, counts)) continue;
    const auto inverse = set(1.0f) / Sqrt(distance_sq * flat_sq);
    const LanePacking packing(d, counts);
    packing.store(turned * inverse, points.block_u.data() + count);
    packing.store(v * inverse, points.block_v.data() + count);
    count += packing.count();
  }
  points.blocking = count;
}

void sweepDirections(const NearPoints& points, std::array<float, kSweepDirections>& inverse) {
  static const auto kTurns = [] {
    std::array<std::array<float, kSweepDirections>, 2> turns;
    for (std::size_t k = 0; k < kSweepDirections; ++k) {
      const double angle = 2 * M_PI * static_cast<double>(k) / kSweepDirections;
      turns[0][k] = static_cast<float>(std::cos(angle));
      turns[1][k] = static_cast<float>(std::sin(angle));
    }
    return turns;
  }();
  const Tag d;
  constexpr std::size_t kTogether = 4;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t k = 0; k < kSweepDirections; k += kTogether * lanes) {
    const auto cosine = [&](std::size_t j)
                            HWY_ATTR { return LoadU(d, kTurns[0].data() + k + j * lanes); };
    const auto sine = [&](std::size_t j)
                          HWY_ATTR { return LoadU(d, kTurns[1].data() + k + j * lanes); };
    const auto c0 = cosine(0), c1 = cosine(1), c2 = cosine(2), c3 = cosine(3);
    const auto s0 = sine(0), s1 = sine(1), s2 = sine(2), s3 = sine(3);
    auto most0 = Zero(d), most1 = Zero(d), most2 = Zero(d), most3 = Zero(d);
    for (std::size_t i = 0; i < points.blocking; ++i) {
      const auto u = set(points.block_u[i]), v = set(points.block_v[i]);
      most0 = Max(most0, MulAdd(u, c0, v * s0));
      most1 = Max(most1, MulAdd(u, c1, v * s1));
      most2 = Max(most2, MulAdd(u, c2, v * s2));
      most3 = Max(most3, MulAdd(u, c3, v * s3));
    }
    StoreU(most0, d, inverse.data() + k);
    StoreU(most1, d, inverse.data() + k + lanes);
    StoreU(most2, d, inverse.data() + k + 2 * lanes);
    StoreU(most3, d, inverse.data() + k + 3 * lanes);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

void NearPoints::reserve(std::size_t capacity) {
  constexpr std::size_t kPadding = 2 * PointStore::kBlock;
  if (x.size() >= capacity + kPadding) return;
  const std::size_t grown = capacity + capacity / 2 + kPadding;
  for (auto* column : {&x, &y, &z, &distance_sq, &own, &block_u, &block_v}) column->resize(grown);
}

namespace kernels {

HWY_EXPORT(gatherOffsets);
HWY_EXPORT(findBlocked);
HWY_EXPORT(sweepDirections);

void gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
                   const Vector3& place, double reach, const PlaceSide& side, NearPoints& points) {
  HWY_DYNAMIC_DISPATCH(gatherOffsets)(store, blocks, place, reach, side, points);
}

void findBlocked(const SweepPlane& plane, double reach, double least, NearPoints& points) {
  HWY_DYNAMIC_DISPATCH(findBlocked)(plane, reach, least, points);
}

void sweepDirections(const NearPoints& points, std::array<float, kSweepDirections>& inverse) {
  HWY_DYNAMIC_DISPATCH(sweepDirections)(points, inverse);
}

}  // namespace kernels
}  // namespace pcl_slim::detail
#endif

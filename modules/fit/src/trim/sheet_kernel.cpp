// SPDX-License-Identifier: BSD-3-Clause
// The points of one surfel's sheet, in its own plane.
#include "trim/sheet_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/sheet_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <int D>
void
gatherSheetOf(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
              SheetPoints& points)
{
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const double scale = 1.0 / surfel.support_radius;
  const ScaledAxes axes(surfel.frame, surfel.support_radius);
  const Height<D> height(surfel.c);
  const auto limit = hn::Set(d, static_cast<float>(surfel.max_residual * scale));
  std::size_t count = 0;
  points.reserve(blocks.size() * PointStore::kBlock);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto [u, v, w] = axes.turn({l.dx, l.dy, l.dz});
    const auto near = hn::And(l.kept, hn::Le(hn::Abs(hn::Sub(w, height(u, v))), limit));
    const LanePacking packing(d, near);
    packing.store(u, points.u.data() + count);
    packing.store(v, points.v.data() + count);
    packing.store(w, points.w.data() + count);
    packing.store(hn::Iota(du, static_cast<std::uint32_t>(i)), points.index.data() + count);
    count += packing.count();
  });
  points.count = count;
  points.pad();
}

void
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
            SheetPoints& points)
{
  forDegree(surfel.degree,
            [&](auto degree) HWY_ATTR { gatherSheetOf<degree()>(store, blocks, surfel, points); });
}

void
findSectors(SheetPoints& points)
{
  constexpr float kTanSector = 0.41421356f;
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const auto zero = hn::Zero(d);
  const auto bit = [&](Mask mask, std::uint32_t value) HWY_ATTR {
    return hn::IfThenElseZero(hn::RebindMask(du, mask), hn::Set(du, value));
  };
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto u = hn::Load(d, points.u.data() + i), v = hn::Load(d, points.v.data() + i);
    const auto a = hn::Abs(u), b = hn::Abs(v);
    const auto oblique = hn::Gt(hn::Min(a, b), hn::Mul(hn::Set(d, kTanSector), hn::Max(a, b)));
    const auto sector = hn::Or(hn::Or(bit(hn::Lt(u, zero), 1), bit(hn::Lt(v, zero), 2)),
                               hn::Or(bit(hn::Gt(b, a), 4), bit(oblique, 8)));
    const auto outside = hn::Gt(hn::Add(hn::Mul(u, u), hn::Mul(v, v)), hn::Set(d, 1.0f));
    hn::Store(hn::IfThenElse(hn::RebindMask(du, outside), hn::Set(du, kSheetSectors), sector), du,
              points.sector.data() + i);
  }
}

float
nearestSq(const SheetPoints& points, float u, float v)
{
  const Tag d;
  const auto at_u = hn::Set(d, u), at_v = hn::Set(d, v);
  auto least = hn::Set(d, hwy::HighestValue<float>());
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = hn::Sub(hn::Load(d, points.u.data() + i), at_u);
    const auto y = hn::Sub(hn::Load(d, points.v.data() + i), at_v);
    least = hn::Min(least, hn::Add(hn::Mul(x, x), hn::Mul(y, y)));
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

QuadrantPoints
nearestInQuadrants(const SheetPoints& points, float u, float v)
{
  const Tag d;
  const auto at_u = hn::Set(d, u), at_v = hn::Set(d, v);
  const auto limit = hn::Set(d, 4.0f * nearestSq(points, u, v));
  QuadrantPoints found;
  HWY_ALIGN float squares[HWY_MAX_BYTES / 4];
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = hn::Sub(hn::Load(d, points.u.data() + i), at_u);
    const auto y = hn::Sub(hn::Load(d, points.v.data() + i), at_v);
    const auto square = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
    const auto near = hn::Le(square, limit);
    if (hn::AllFalse(d, near)) continue;
    hn::Store(square, d, squares);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, near, bits);
    for (unsigned mask = bits[0] | static_cast<unsigned>(bits[1]) << 8; mask != 0;
         mask &= mask - 1) {
      const auto k = static_cast<std::size_t>(__builtin_ctz(mask));
      const std::size_t side = (points.u[i + k] < u ? 1u : 0u) + (points.v[i + k] < v ? 2u : 0u);
      if (found.nearest[side] != QuadrantPoints::kNone && squares[k] >= found.distance_sq[side])
        continue;
      found.nearest[side] = static_cast<std::uint32_t>(i + k);
      found.distance_sq[side] = squares[k];
    }
  }
  return found;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(gatherSheet);
HWY_EXPORT(findSectors);
HWY_EXPORT(nearestSq);
HWY_EXPORT(nearestInQuadrants);

void
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
            SheetPoints& points)
{
  HWY_DYNAMIC_DISPATCH(gatherSheet)(store, blocks, surfel, points);
}

void
findSectors(SheetPoints& points)
{
  HWY_DYNAMIC_DISPATCH(findSectors)(points);
}

float
nearestSq(const SheetPoints& points, float u, float v)
{
  return HWY_DYNAMIC_DISPATCH(nearestSq)(points, u, v);
}

QuadrantPoints
nearestInQuadrants(const SheetPoints& points, float u, float v)
{
  return HWY_DYNAMIC_DISPATCH(nearestInQuadrants)(points, u, v);
}

}  // namespace pcl_slim::detail::kernels
#endif

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
  const auto limit = set(static_cast<float>(surfel.max_residual * scale));
  std::size_t count = 0;
  points.reserve(blocks.size() * PointStore::kBlock);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto [u, v, w] = axes.turn({l.dx, l.dy, l.dz});
    const auto near = And(l.kept, Abs(w - height(u, v)) <= limit);
    const LanePacking packing(d, near);
    packing.store(u, points.u.data() + count);
    packing.store(v, points.v.data() + count);
    packing.store(w, points.w.data() + count);
    packing.store(Iota(du, static_cast<std::uint32_t>(i)), points.index.data() + count);
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
  const auto zero = Zero(d);
  const auto bit = [&](Mask mask, std::uint32_t value)
                       HWY_ATTR { return IfThenElseZero(RebindMask(du, mask), Set(du, value)); };
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto u = Load(d, points.u.data() + i), v = Load(d, points.v.data() + i);
    const auto a = Abs(u), b = Abs(v);
    const auto oblique = Min(a, b) > set(kTanSector) * Max(a, b);
    const auto sector = bit(u < zero, 1) | bit(v < zero, 2) | (bit(b > a, 4) | bit(oblique, 8));
    const auto outside = u * u + v * v > set(1.0f);
    Store(IfThenElse(RebindMask(du, outside), Set(du, kSheetSectors), sector), du,
          points.sector.data() + i);
  }
}

float
nearestSq(const SheetPoints& points, float u, float v)
{
  const Tag d;
  const auto at_u = set(u), at_v = set(v);
  auto least = set(hwy::HighestValue<float>());
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = Load(d, points.u.data() + i) - at_u;
    const auto y = Load(d, points.v.data() + i) - at_v;
    least = Min(least, x * x + y * y);
  }
  return GetLane(MinOfLanes(d, least));
}

QuadrantPoints
nearestInQuadrants(const SheetPoints& points, float u, float v)
{
  const Tag d;
  const auto at_u = set(u), at_v = set(v);
  const auto limit = set(4.0f * nearestSq(points, u, v));
  QuadrantPoints found;
  HWY_ALIGN float squares[HWY_MAX_BYTES / 4];
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = Load(d, points.u.data() + i) - at_u;
    const auto y = Load(d, points.v.data() + i) - at_v;
    const auto square = x * x + y * y;
    const auto near = square <= limit;
    if (AllFalse(d, near)) continue;
    Store(square, d, squares);
    std::uint8_t bits[8] = {};
    StoreMaskBits(d, near, bits);
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

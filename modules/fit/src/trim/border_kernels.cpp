// SPDX-License-Identifier: BSD-3-Clause
#include "trim/border_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/border_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/lane_packing-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void
gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
              const Vector3& place, double reach, const PlaceSide& side, NearPoints& points)
{
  const Tag d;
  const auto limit = set(static_cast<float>(reach * reach));
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
      auto near = distance_sq <= limit;
      if (AllFalse(d, near)) continue;
      if (side.min_dot > -1) {
        const auto cosine =
            dot3(Load(d, store.nx() + i), Load(d, store.ny() + i), Load(d, store.nz() + i),
                 set(side.normal[0]), set(side.normal[1]), set(side.normal[2]));
        near = And(near, cosine > set(side.min_dot));
      }
      if (AllFalse(d, near)) continue;
      const LanePacking packing(d, near);
      packing.store(dx, points.x.data() + count);
      packing.store(dy, points.y.data() + count);
      packing.store(dz, points.z.data() + count);
      packing.store(distance_sq, points.distance_sq.data() + count);
      count += packing.count();
    }
  }
  points.count = count;
  for (auto* column : {&points.x, &points.y, &points.z}) {
    StoreU(Zero(d), d, column->data() + count);
  }
}

/** The sectors of directions; 0 where a lane does not count. */
HWY_INLINE hn::Vec<hn::RebindToSigned<Tag>>
sectorsOf(Vec u, Vec v, Mask counts)
{
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto along = v / (Abs(u) + Abs(v));  // -1 to 1
  const auto right = along + IfThenElseZero(along < Zero(d), set(4.0f));
  const auto turn = IfThenElse(u >= Zero(d), right, set(2.0f) - along);
  const auto sector = IfThenElseZero(counts, turn * set(kBorderSectors / 4.0f));
  return ConvertTo(di, sector) & Set(di, kBorderSectors - 1);
}

std::uint64_t
projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points)
{
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto axis = [&](std::size_t k, std::size_t a)
                        HWY_ATTR { return set(static_cast<float>(axes[k][a])); };
  const auto ux = axis(0, 0), uy = axis(0, 1), uz = axis(0, 2);
  const auto vx = axis(1, 0), vy = axis(1, 1), vz = axis(1, 2);
  const auto wx = axis(2, 0), wy = axis(2, 1), wz = axis(2, 2);
  const auto blind_sq = set(static_cast<float>(blind * blind));
  std::uint64_t taken = 0;
  HWY_ALIGN std::int32_t sectors[HWY_MAX_BYTES / 4];
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = Load(d, points.x.data() + i), y = Load(d, points.y.data() + i),
               z = Load(d, points.z.data() + i);
    const auto u = dot3(x, y, z, ux, uy, uz), v = dot3(x, y, z, vx, vy, vz);
    Store(u, d, points.u.data() + i);
    Store(v, d, points.v.data() + i);
    Store(dot3(x, y, z, wx, wy, wz), d, points.w.data() + i);
    const auto far = MulAdd(u, u, v * v) > blind_sq;
    Store(sectorsOf(u, v, far), di, sectors);
    std::uint8_t bits[8] = {};
    StoreMaskBits(d, far, bits);
    for (unsigned mask = bits[0] | static_cast<unsigned>(bits[1]) << 8; mask != 0;
         mask &= mask - 1) {
      taken |= std::uint64_t{1} << sectors[__builtin_ctz(mask)];
    }
  }
  return taken;
}

/** Takes the lane of the nearest point, the first of equally near ones. */
HWY_INLINE void
takeNearest(Vec squares, hn::Vec<hn::RebindToSigned<Tag>> numbers, EmptyDisc& disc)
{
  const Tag d;
  HWY_ALIGN float square[HWY_MAX_BYTES / 4];
  HWY_ALIGN std::int32_t number[HWY_MAX_BYTES / 4];
  Store(squares, d, square);
  Store(numbers, hn::RebindToSigned<Tag>(), number);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (number[k] < 0 || square[k] > disc.next_sq) continue;
    if (square[k] == disc.next_sq && disc.next >= 0 && number[k] > disc.next) continue;
    disc.next_sq = square[k];
    disc.next = number[k];
  }
}

void
findDisc(const NearPoints& points, double thick, EmptyDisc& disc)
{
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto thick_sq = set(static_cast<float>(thick * thick));
  const auto du = set(disc.u), dv = set(disc.v);
  auto width = set(disc.width), next_sq = set(disc.next_sq);
  auto next = Set(di, -1);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto u = Load(d, points.u.data() + i), v = Load(d, points.v.data() + i),
               w = Load(d, points.w.data() + i);
    const auto square = MulAdd(u, u, v * v);
    const auto ahead = MulAdd(du, u, dv * v);
    const auto counts = And(w * w <= square + thick_sq, ahead > Zero(d));
    width = IfThenElse(counts, Min(width, square / ahead), width);
    const auto within = set(4.0f) * (ahead * ahead) > square;
    const auto nearer = And(counts, And(square < next_sq, within));
    next_sq = IfThenElse(nearer, square, next_sq);
    next = IfThenElse(RebindMask(di, nearer), Iota(di, static_cast<std::int32_t>(i)), next);
  }
  disc.width = GetLane(MinOfLanes(d, width));
  takeNearest(next_sq, next, disc);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

void
NearPoints::reserve(std::size_t capacity)
{
  constexpr std::size_t kPadding = 2 * PointStore::kBlock;
  if (x.size() >= capacity + kPadding) return;
  const std::size_t grown = capacity + capacity / 2 + kPadding;
  for (auto* column : {&x, &y, &z, &distance_sq, &u, &v, &w}) column->resize(grown);
}

namespace kernels {

HWY_EXPORT(gatherOffsets);
HWY_EXPORT(projectOffsets);
HWY_EXPORT(findDisc);

void
gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
              const Vector3& place, double reach, const PlaceSide& side, NearPoints& points)
{
  HWY_DYNAMIC_DISPATCH(gatherOffsets)(store, blocks, place, reach, side, points);
}

std::uint64_t
projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points)
{
  return HWY_DYNAMIC_DISPATCH(projectOffsets)(axes, blind, points);
}

void
findDisc(const NearPoints& points, double thick, EmptyDisc& disc)
{
  HWY_DYNAMIC_DISPATCH(findDisc)(points, thick, disc);
}

}  // namespace kernels
}  // namespace pcl_slim::detail
#endif

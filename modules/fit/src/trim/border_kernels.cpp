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
  const auto limit = hn::Set(d, static_cast<float>(reach * reach));
  points.reserve(blocks.size() * PointStore::kBlock);
  std::size_t count = 0;
  for (const std::size_t b : blocks) {
    const auto sx = hn::Set(d, static_cast<float>(store.blockOriginX()[b] - place[0]));
    const auto sy = hn::Set(d, static_cast<float>(store.blockOriginY()[b] - place[1]));
    const auto sz = hn::Set(d, static_cast<float>(store.blockOriginZ()[b] - place[2]));
    for (std::size_t i = b * PointStore::kBlock; i < (b + 1) * PointStore::kBlock;
         i += hn::Lanes(d)) {
      const auto dx = hn::Add(hn::Load(d, store.x() + i), sx);
      const auto dy = hn::Add(hn::Load(d, store.y() + i), sy);
      const auto dz = hn::Add(hn::Load(d, store.z() + i), sz);
      const auto distance_sq = dot3(dx, dy, dz, dx, dy, dz);
      auto near = hn::Le(distance_sq, limit);
      if (hn::AllFalse(d, near)) continue;
      if (side.min_dot > -1) {
        const auto cosine = dot3(hn::Load(d, store.nx() + i), hn::Load(d, store.ny() + i),
                                 hn::Load(d, store.nz() + i), hn::Set(d, side.normal[0]),
                                 hn::Set(d, side.normal[1]), hn::Set(d, side.normal[2]));
        near = hn::And(near, hn::Gt(cosine, hn::Set(d, side.min_dot)));
      }
      if (hn::AllFalse(d, near)) continue;
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
    hn::StoreU(hn::Zero(d), d, column->data() + count);
  }
}

/** The sectors of directions; 0 where a lane does not count. */
HWY_INLINE hn::Vec<hn::RebindToSigned<Tag>>
sectorsOf(Vec u, Vec v, Mask counts)
{
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto along = hn::Div(v, hn::Add(hn::Abs(u), hn::Abs(v)));  // -1 to 1
  const auto right =
      hn::Add(along, hn::IfThenElseZero(hn::Lt(along, hn::Zero(d)), hn::Set(d, 4.0f)));
  const auto turn = hn::IfThenElse(hn::Ge(u, hn::Zero(d)), right, hn::Sub(hn::Set(d, 2.0f), along));
  const auto sector = hn::IfThenElseZero(counts, hn::Mul(turn, hn::Set(d, kBorderSectors / 4.0f)));
  return hn::And(hn::ConvertTo(di, sector), hn::Set(di, kBorderSectors - 1));
}

std::uint64_t
projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points)
{
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto axis = [&](std::size_t k, std::size_t a)
                        HWY_ATTR { return hn::Set(d, static_cast<float>(axes[k][a])); };
  const auto ux = axis(0, 0), uy = axis(0, 1), uz = axis(0, 2);
  const auto vx = axis(1, 0), vy = axis(1, 1), vz = axis(1, 2);
  const auto wx = axis(2, 0), wy = axis(2, 1), wz = axis(2, 2);
  const auto blind_sq = hn::Set(d, static_cast<float>(blind * blind));
  std::uint64_t taken = 0;
  HWY_ALIGN std::int32_t sectors[HWY_MAX_BYTES / 4];
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto x = hn::Load(d, points.x.data() + i), y = hn::Load(d, points.y.data() + i),
               z = hn::Load(d, points.z.data() + i);
    const auto u = dot3(x, y, z, ux, uy, uz), v = dot3(x, y, z, vx, vy, vz);
    hn::Store(u, d, points.u.data() + i);
    hn::Store(v, d, points.v.data() + i);
    hn::Store(dot3(x, y, z, wx, wy, wz), d, points.w.data() + i);
    const auto far = hn::Gt(hn::MulAdd(u, u, hn::Mul(v, v)), blind_sq);
    hn::Store(sectorsOf(u, v, far), di, sectors);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, far, bits);
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
  hn::Store(squares, d, square);
  hn::Store(numbers, hn::RebindToSigned<Tag>(), number);
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
  const auto thick_sq = hn::Set(d, static_cast<float>(thick * thick));
  const auto du = hn::Set(d, disc.u), dv = hn::Set(d, disc.v);
  auto width = hn::Set(d, disc.width), next_sq = hn::Set(d, disc.next_sq);
  auto next = hn::Set(di, -1);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(d)) {
    const auto u = hn::Load(d, points.u.data() + i), v = hn::Load(d, points.v.data() + i),
               w = hn::Load(d, points.w.data() + i);
    const auto square = hn::MulAdd(u, u, hn::Mul(v, v));
    const auto ahead = hn::MulAdd(du, u, hn::Mul(dv, v));
    const auto counts =
        hn::And(hn::Le(hn::Mul(w, w), hn::Add(square, thick_sq)), hn::Gt(ahead, hn::Zero(d)));
    width = hn::IfThenElse(counts, hn::Min(width, hn::Div(square, ahead)), width);
    const auto within = hn::Gt(hn::Mul(hn::Set(d, 4.0f), hn::Mul(ahead, ahead)), square);
    const auto nearer = hn::And(counts, hn::And(hn::Lt(square, next_sq), within));
    next_sq = hn::IfThenElse(nearer, square, next_sq);
    next = hn::IfThenElse(hn::RebindMask(di, nearer), hn::Iota(di, static_cast<std::int32_t>(i)),
                          next);
  }
  disc.width = hn::GetLane(hn::MinOfLanes(d, width));
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

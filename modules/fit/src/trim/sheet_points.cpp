// SPDX-License-Identifier: BSD-3-Clause
// The points of one surfel's sheet, in its own plane.
#include "trim/trim.h"

#include <cmath>

#include "pcl_slim/core/vector3.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trim/sheet_points.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <int D>
void gatherSheetOf(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
                   SheetPoints& points) {
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

void gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
                 SheetPoints& points) {
  forDegree(surfel.degree,
            [&](auto degree) HWY_ATTR { gatherSheetOf<degree()>(store, blocks, surfel, points); });
}

void findSectors(SheetPoints& points) {
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

float nearestSq(const SheetPoints& points, float u, float v) {
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

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {
namespace kernels {

HWY_EXPORT(gatherSheet);
HWY_EXPORT(findSectors);
HWY_EXPORT(nearestSq);

void gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
                 SheetPoints& points) {
  HWY_DYNAMIC_DISPATCH(gatherSheet)(store, blocks, surfel, points);
}

void findSectors(SheetPoints& points) {
  HWY_DYNAMIC_DISPATCH(findSectors)(points);
}

float nearestSq(const SheetPoints& points, float u, float v) {
  return HWY_DYNAMIC_DISPATCH(nearestSq)(points, u, v);
}

}  // namespace kernels

namespace {

constexpr int kLeastSectors = 4;
constexpr std::size_t kPointsOfSector = 3;  ///< fewer leave too many sectors empty by chance

/** Points of one direction. */
struct Sector {
  float farthest_sq = 0.0f;
  int count = 0;

  void add(float distance_sq) {
    farthest_sq = std::max(farthest_sq, distance_sq);
    ++count;
  }

  void add(const Sector& other) {
    farthest_sq = std::max(farthest_sq, other.farthest_sq);
    count += other.count;
  }

  /** Radius squared of the points' region: of m even ones the farthest is expected at m / (m + 1).
   */
  double reachSq() const {
    if (count == 0) return 0.0;
    return std::min(1.0, static_cast<double>(farthest_sq) * (count + 1) / count);
  }
};

/** Whether a surfel covers a stored point; offset from the centre in radii. */
bool covers(const PointStore& store, std::size_t i, const kernels::CoverLeaf& surfel,
            const Vector3& offset) {
  const double reach = surfel.ball.radius / surfel.support_radius;
  if (!(dot(offset, offset) < reach * reach)) return false;
  if (const float* bound = surfel.ball.bound_normal) {
    const auto n = store.normal(i);
    if (!(n[0] * bound[0] + n[1] * bound[1] + n[2] * bound[2] > surfel.ball.min_dot)) return false;
  }
  const double height = evaluateHeight(surfel.degree, surfel.c, dot(offset, surfel.frame.u),
                                       dot(offset, surfel.frame.v));
  return std::abs(dot(offset, surfel.frame.w) - height) * surfel.support_radius <=
         surfel.max_residual;
}

}  // namespace

void sampleSheet(const PointStore& store, const BlockList& blocks, const kernels::CoverLeaf& surfel,
                 SheetPoints& points) {
  points.reserve(blocks.size());
  points.count = 0;
  const auto& center = surfel.ball.center;
  for (const std::uint32_t b : blocks) {
    const std::size_t i = b * PointStore::kBlock + PointStore::kBlock / 2;
    if (i >= store.size()) continue;
    const Vector3 offset = scaled(subtract(store.position(i), {center[0], center[1], center[2]}),
                                  1.0 / surfel.support_radius);
    if (!covers(store, i, surfel, offset)) continue;
    points.u[points.count] = static_cast<float>(dot(offset, surfel.frame.u));
    points.v[points.count] = static_cast<float>(dot(offset, surfel.frame.v));
    points.index[points.count] = static_cast<std::uint32_t>(i);
    points.w[points.count++] = static_cast<float>(dot(offset, surfel.frame.w));
  }
  points.pad();
}

double spacingOf(SheetPoints& points) {
  kernels::findSectors(points);
  constexpr std::size_t kChains = 4;  // sums that do not wait for each other
  Sector chains[kChains][kernels::kSheetSectors + 1];
  for (std::size_t i = 0; i < points.count; ++i) {
    const float u = points.u[i], v = points.v[i];
    chains[i % kChains][points.sector[i]].add(u * u + v * v);
  }
  auto& sectors = chains[0];
  for (std::size_t chain = 1; chain < kChains; ++chain)
    for (std::size_t k = 0; k <= kernels::kSheetSectors; ++k) sectors[k].add(chains[chain][k]);
  const std::size_t inside =
      points.count - static_cast<std::size_t>(sectors[kernels::kSheetSectors].count);
  if (inside == 0) return 0.0;
  int count = kernels::kSheetSectors;
  while (count > kLeastSectors && inside < kPointsOfSector * static_cast<std::size_t>(count)) {
    count /= 2;
    for (int k = 0; k < count; ++k) sectors[k].add(sectors[k + count]);
  }
  double area = 0.0;
  for (int k = 0; k < count; ++k) area += sectors[k].reachSq() * M_PI / count;
  return std::sqrt(area / static_cast<double>(inside));
}

}  // namespace pcl_slim::detail
#endif

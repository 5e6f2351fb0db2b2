// SPDX-License-Identifier: BSD-3-Clause
#include "trim/sheet_points.h"

#include <cmath>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr int kLeastSectors = 4;
constexpr std::size_t kPointsOfSector = 3;  ///< fewer leave too many sectors empty by chance

/** Points of one direction. */
struct Sector {
  float farthest_sq = 0.0f;
  int count = 0;

  void add(float distance_sq)
  {
    farthest_sq = std::max(farthest_sq, distance_sq);
    ++count;
  }

  void add(const Sector& other)
  {
    farthest_sq = std::max(farthest_sq, other.farthest_sq);
    count += other.count;
  }

  /** Radius squared of the points' region: of m even ones the farthest is expected at m / (m + 1). */
  double reachSq() const
  {
    if (count == 0) return 0.0;
    return std::min(1.0, static_cast<double>(farthest_sq) * (count + 1) / count);
  }
};

/** Whether a surfel serves a stored point, told from the centre in radii. */
bool
serves(const PointStore& store, std::size_t i, const kernels::CoverLeaf& surfel,
       const Vector3& offset)
{
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

void
sampleSheet(const PointStore& store, const BlockList& blocks, const kernels::CoverLeaf& surfel,
            SheetPoints& points)
{
  points.reserve(blocks.size());
  points.count = 0;
  const auto& center = surfel.ball.center;
  for (const std::uint32_t b : blocks) {
    const std::size_t i = b * PointStore::kBlock + PointStore::kBlock / 2;
    if (i >= store.size()) continue;
    const Vector3 offset = scaled(subtract(store.position(i), {center[0], center[1], center[2]}),
                                  1.0 / surfel.support_radius);
    if (!serves(store, i, surfel, offset)) continue;
    points.u[points.count] = static_cast<float>(dot(offset, surfel.frame.u));
    points.v[points.count] = static_cast<float>(dot(offset, surfel.frame.v));
    points.index[points.count] = static_cast<std::uint32_t>(i);
    points.w[points.count++] = static_cast<float>(dot(offset, surfel.frame.w));
  }
  points.pad();
}

double
spacingOf(SheetPoints& points)
{
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

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/splat_radius.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr double kMargin = 1.0;              ///< spacings beyond a cell's own points
constexpr double kNeighborMargin = 0.35;     ///< spacings beyond midpoints
constexpr double kWidest = 6.0;              ///< middle spacings that count as widest
constexpr std::size_t kSpacingCells = 4096;  ///< cells that tell the middle spacing
constexpr std::size_t kSpacingNeighbors = 6, kNeighbors = 8;

/** Squared distance from the disc's centre. In a flat cell it is the distance in the disc's plane;
 * where normals differ, what lies above or below widens the disc, as rays pass there aslant. */
double
distanceSq(const Disc& disc, const double point[3])
{
  double sq = 0;
  for (std::size_t a = 0; a < 3; ++a)
    sq += (point[a] - disc.center[a]) * (point[a] - disc.center[a]);
  return sq;
}

/** Neighbours of points of an OctreeCloud, found in the PointStore of the same points. */
class Neighbors {
 public:
  Neighbors(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells, const PointStore& store)
      : store_(store), stored_(store.storeOfInput()), place_(stored_.size(), 0), cell_(cloud.size())
  {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      place_[cloud.point(i).order] = static_cast<std::uint32_t>(i);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      for (std::size_t i = cells[c].begin; i < cells[c].end; ++i) {
        cell_[i] = static_cast<std::uint32_t>(c);
      }
    }
  }

  const PointStore& store() const { return store_; }
  bool known(const OctreePoint& q) const { return stored_[q.order] != PointStore::kSkipped; }
  std::size_t storedOf(const OctreePoint& q) const { return stored_[q.order]; }
  std::size_t placeOf(std::uint32_t stored) const { return place_[store_.orderOfStore()[stored]]; }
  std::uint32_t cellOf(std::size_t place) const { return cell_[place]; }

 private:
  const PointStore& store_;
  std::vector<std::uint32_t> stored_, place_, cell_;
};

/** Radius of one cell by kNeighbors. */
double
neighborRadius(const OctreeCloud& cloud, const OctreeCell& cell, std::uint32_t number,
               const Disc& disc, const Neighbors& neighbors, double widest, NeighborSearch& search)
{
  thread_local std::vector<std::uint32_t> near;
  thread_local std::vector<float> distances_sq;
  const double unit = neighbors.store().scale() / cloud.cell();
  double radius = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const OctreePoint& q = cloud.point(i);
    const double p[3] = {q.position[0], q.position[1], q.position[2]};
    double reach_sq = distanceSq(disc, p), spacing = 0;
    if (neighbors.known(q)) {
      search.nearest(neighbors.storedOf(q), kNeighbors + 1, near, distances_sq);
      const std::size_t counted = std::min(kSpacingNeighbors, near.size() - 1);
      for (std::size_t k = 1; k <= counted; ++k) spacing += unit * std::sqrt(distances_sq[k]);
      if (counted > 0) spacing = std::min(spacing / static_cast<double>(counted), widest);
      for (std::size_t k = 1; k < near.size(); ++k) {
        if (unit * std::sqrt(distances_sq[k]) > 2.0 * widest) break;
        const std::size_t other = neighbors.placeOf(near[k]);
        if (neighbors.cellOf(other) == number) continue;
        const float* o = cloud.point(other).position;
        const double middle[3] = {0.5 * (p[0] + o[0]), 0.5 * (p[1] + o[1]), 0.5 * (p[2] + o[2])};
        reach_sq = std::max(reach_sq, distanceSq(disc, middle));
      }
    }
    radius = std::max(radius, std::sqrt(reach_sq) + kNeighborMargin * spacing);
  }
  return radius;
}

}  // namespace

double
cornerRadius(const std::array<double, 3>& point, const std::array<double, 3>& cube_center,
             double edge)
{
  double sq = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = 0.5 * edge + std::abs(point[a] - cube_center[a]);
    sq += d * d;
  }
  return std::sqrt(sq);
}

double
reachOfPoints(const OctreeCloud& cloud, const OctreeCell& cell, const Disc& disc)
{
  double largest = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const float* q = cloud.point(i).position;
    const double p[3] = {q[0], q[1], q[2]};
    largest = std::max(largest, distanceSq(disc, p));
  }
  return std::sqrt(largest);
}

double
widestSpacing(const std::vector<OctreeCell>& cells)
{
  std::vector<std::pair<float, std::uint32_t>> known;
  std::uint64_t points = 0;
  // Some thousand cells tell the middle as well as all.
  const std::size_t stride = std::max<std::size_t>(1, cells.size() / kSpacingCells);
  for (std::size_t c = 0; c < cells.size(); c += stride) {
    const OctreeCell& cell = cells[c];
    if (!(cell.spacing > 0)) continue;
    known.emplace_back(cell.spacing, cell.end - cell.begin);
    points += cell.end - cell.begin;
  }
  std::sort(known.begin(), known.end());
  std::uint64_t passed = 0;
  for (const auto& [spacing, count] : known) {
    passed += count;
    if (2 * passed >= points) return kWidest * spacing;
  }
  return 0.0;
}

double
densityRadius(const OctreeCell& cell, double reach, double widest)
{
  return reach + kMargin * std::min(static_cast<double>(cell.spacing), widest);
}

std::vector<float>
neighborRadii(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells,
              const std::vector<Disc>& discs, const PointStore& store, int threads)
{
  threads = resolveThreads(threads);
  std::vector<float> radii(cells.size(), 0.0f);
  if (!(cloud.cell() > 0)) return radii;
  const Neighbors neighbors(cloud, cells, store);
  const double widest = widestSpacing(cells);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  parallelFor(cells.size(), threads, 64, [&](std::size_t c, int thread) {
    radii[c] = static_cast<float>(neighborRadius(cloud, cells[c], static_cast<std::uint32_t>(c),
                                                 discs[c], neighbors, widest,
                                                 searches[static_cast<std::size_t>(thread)]));
  });
  return radii;
}

}  // namespace pcl_slim

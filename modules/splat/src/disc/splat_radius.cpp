// SPDX-License-Identifier: BSD-3-Clause
// docs/color_octree_splat_sampler.md, section "Radius".
#include "pcl_slim/splat/splat_radius.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr double kMargin = 1.0;           ///< spacings beyond a cell's own points
constexpr double kMarginOfFew = 0.3;      ///< and more, over the root of their number
constexpr double kMarginOfBend = 0.5;     ///< and more, times the deviation of normals
constexpr double kNeighborMargin = 0.35;  ///< spacings beyond midpoints
constexpr std::size_t kSpacingNeighbors = 6, kNeighbors = 8;

using Vector = std::array<double, 3>;

/** Distance from the disc's centre. In a flat cell it is the distance in the disc's plane; where
 * normals differ, points above or below widen the disc, as rays pass there aslant. */
double distanceSq(const std::array<float, 3>& center, const Vector& point) {
  double sq = 0;
  for (std::size_t a = 0; a < 3; ++a) sq += (point[a] - center[a]) * (point[a] - center[a]);
  return sq;
}

/** Finds how far discs must reach around single points of a store. */
class NeighborReach {
 public:
  NeighborReach(const OctreeCloud& cloud, const std::vector<std::array<float, 3>>& centers,
                const std::vector<std::uint32_t>& disc_of, const PointStore& store, double widest)
      : cloud_(cloud), centers_(centers), disc_of_(disc_of), store_(store), widest_(widest) {}

  std::uint32_t discOf(std::size_t stored) const { return disc_of_[store_.orderOfStore()[stored]]; }

  /** Radius that the disc of a stored point needs for it. */
  double reach(std::size_t stored, NeighborSearch& search, std::vector<std::uint32_t>& near,
               std::vector<float>& distances_sq) const {
    const double unit = store_.scale() * cloud_.frame().scale;
    const std::uint32_t disc = discOf(stored);
    const Vector p = position(stored);
    double reach_sq = distanceSq(centers_[disc], p), spacing = 0;
    search.nearest(stored, kNeighbors + 1, near, distances_sq);
    const std::size_t counted = std::min(kSpacingNeighbors, near.size() - 1);
    for (std::size_t k = 1; k <= counted; ++k) spacing += unit * std::sqrt(distances_sq[k]);
    if (counted > 0) spacing = std::min(spacing / static_cast<double>(counted), widest_);
    for (std::size_t k = 1; k < near.size(); ++k) {
      if (unit * std::sqrt(distances_sq[k]) > 2.0 * widest_) break;
      if (discOf(near[k]) == disc) continue;
      const Vector o = position(near[k]);
      const Vector middle = {0.5 * (p[0] + o[0]), 0.5 * (p[1] + o[1]), 0.5 * (p[2] + o[2])};
      reach_sq = std::max(reach_sq, distanceSq(centers_[disc], middle));
    }
    return std::sqrt(reach_sq) + kNeighborMargin * spacing;
  }

 private:
  /** In root cells. */
  Vector position(std::size_t stored) const {
    const auto local = store_.position(stored);
    Vector p;
    for (std::size_t a = 0; a < 3; ++a) {
      const double world =
          local[a] * store_.scale() + (store_.origin()[a] - cloud_.frame().origin[a]);
      p[a] = world * cloud_.frame().scale;
    }
    return p;
  }

  const OctreeCloud& cloud_;
  const std::vector<std::array<float, 3>>& centers_;
  const std::vector<std::uint32_t>& disc_of_;
  const PointStore& store_;
  double widest_;
};

}  // namespace

double cornerRadius(const std::array<double, 3>& point, const std::array<double, 3>& cube_center,
                    double edge) {
  double sq = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = 0.5 * edge + std::abs(point[a] - cube_center[a]);
    sq += d * d;
  }
  return std::sqrt(sq);
}

double widestSpacing(std::vector<CellSpacing>& cells) {
  std::sort(cells.begin(), cells.end(), [](const CellSpacing& a, const CellSpacing& b) {
    return a.spacing != b.spacing ? a.spacing < b.spacing : a.points < b.points;
  });
  std::uint64_t points = 0, passed = 0;
  for (const CellSpacing& cell : cells) points += cell.spacing > 0 ? cell.points : 0;
  for (const CellSpacing& cell : cells) {
    passed += cell.spacing > 0 ? cell.points : 0;
    if (2 * passed >= points && cell.spacing > 0) return kWidestSpacings * cell.spacing;
  }
  return 0.0;
}

double densityRadius(double reach, double points, double bend, double spacing, double widest) {
  const double margin = kMargin + kMarginOfFew / std::sqrt(points) + kMarginOfBend * bend;
  return reach + margin * std::min(spacing, widest);
}

std::vector<float> neighborRadii(const OctreeCloud& cloud,
                                 const std::vector<std::array<float, 3>>& centers,
                                 const std::vector<std::uint32_t>& disc_of, const PointStore& store,
                                 double widest, int threads) {
  std::vector<float> radii(centers.size(), 0.0f);
  if (!(cloud.cell() > 0)) return radii;
  const NeighborReach neighbors(cloud, centers, disc_of, store, widest);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  std::vector<float> reaches(store.size());
  parallelFor(store.size(), threads, 1024, [&](std::size_t i, int thread) {
    thread_local std::vector<std::uint32_t> near;
    thread_local std::vector<float> distances_sq;
    reaches[i] = static_cast<float>(
        neighbors.reach(i, searches[static_cast<std::size_t>(thread)], near, distances_sq));
  });
  for (std::size_t i = 0; i < reaches.size(); ++i) {
    float& radius = radii[neighbors.discOf(i)];
    radius = std::max(radius, reaches[i]);
  }
  return radii;
}

}  // namespace pcl_slim

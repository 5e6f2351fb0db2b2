// SPDX-License-Identifier: BSD-3-Clause
#include "gaps/gap_chains.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "orient/overlap_graph.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr double kFarthestOff = 0.5;  ///< [r] polynomials part where there are no points

/** Sets of gaps: each gap's set is named by its first. */
class GapSets {
 public:
  explicit GapSets(std::size_t count) : parent_(count)
  {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }

  std::uint32_t find(std::uint32_t gap)
  {
    while (parent_[gap] != gap) gap = parent_[gap] = parent_[parent_[gap]];
    return gap;
  }

  void join(std::uint32_t a, std::uint32_t b)
  {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/** The frames of a leaf and of one that overlaps it. */
class PlaceMap {
 public:
  PlaceMap(const SLIMSurface& surface, std::uint32_t from, std::uint32_t to)
      : surface_(surface), from_(from), to_(to), own_(frameOf(from)), other_(frameOf(to))
  {
    offset_ = subtract({surface.cx[from], surface.cy[from], surface.cz[from]},
                       {surface.cx[to], surface.cy[to], surface.cz[to]});
  }

  /** \brief Where a place of one leaf is in the other's plane. \return false: off its sheet. */
  bool map(double u, double v, double& to_u, double& to_v) const
  {
    const double h = evaluateHeight(surface_.degree[from_], surface_.coefficientsOf(from_), u, v);
    const double r = surface_.radius[from_], inverse = 1.0 / surface_.radius[to_];
    Vector3 place;
    for (std::size_t a = 0; a < 3; ++a) {
      place[a] = offset_[a] + r * (u * own_.u[a] + v * own_.v[a] + h * own_.w[a]);
      place[a] *= inverse;
    }
    to_u = dot(place, other_.u);
    to_v = dot(place, other_.v);
    const double to_h =
        evaluateHeight(surface_.degree[to_], surface_.coefficientsOf(to_), to_u, to_v);
    return std::abs(dot(place, other_.w) - to_h) <= kFarthestOff;
  }

 private:
  LocalFrame frameOf(std::uint32_t i) const
  {
    return LocalFrame({surface_.nx[i], surface_.ny[i], surface_.nz[i]});
  }

  const SLIMSurface& surface_;
  std::uint32_t from_, to_;
  LocalFrame own_, other_;
  Vector3 offset_;
};

using Join = std::pair<std::uint32_t, std::uint32_t>;  ///< numbers of gaps

void
addJoins(const SLIMSurface& surface, const LeafGaps& from, std::uint32_t first_from,
         const LeafGaps& to, std::uint32_t first_to, std::vector<Join>& joins)
{
  const PlaceMap map(surface, from.surfel, to.surfel);
  for (const LeafGaps::Place& place : from.ends) {
    double u, v;
    if (!map.map(place.u, place.v, u, v)) continue;
    const int gap = to.gapAt(u, v);
    if (gap < 0) continue;
    const Join join{first_from + place.gap, first_to + static_cast<std::uint32_t>(gap)};
    if (joins.empty() || joins.back() != join) joins.push_back(join);
  }
}

}  // namespace

int
LeafGaps::gapAt(double u, double v) const
{
  const double x = std::floor(half + cells_per_unit * u), y = std::floor(half + cells_per_unit * v);
  const auto before = [](const Run& run, double row) { return run.y < row; };
  for (auto run = std::lower_bound(runs.begin(), runs.end(), y, before);
       run != runs.end() && run->y == y; ++run) {
    if (run->first <= x && x <= run->last) return run->gap;
  }
  return -1;
}

bool
LeafGaps::hasReal() const
{
  return std::any_of(real.begin(), real.end(), [](std::uint8_t r) { return r != 0; });
}

bool
LeafGaps::reachesIn(std::uint32_t gap, double distance) const
{
  const double limit = distance * cells_per_unit;
  for (const Run& run : runs) {
    if (run.gap != gap) continue;
    const double x = std::clamp<double>(half, run.first + 0.5, run.last + 0.5) - half;
    if (std::hypot(x, run.y + 0.5 - half) < limit) return true;
  }
  return false;
}

LeafGaps
leafGapsOf(const GapGrid& grid, std::uint32_t surfel)
{
  LeafGaps gaps;
  gaps.surfel = surfel;
  gaps.count = static_cast<std::uint16_t>(grid.numGaps());
  gaps.cells_per_unit = static_cast<float>(grid.cellsPerUnit());
  gaps.half = static_cast<float>(grid.half());
  gaps.real.assign(gaps.count, 0);
  gaps.runs.reserve(grid.runs().size());
  struct Ends {
    int x[4], y[4];
    bool any = false;
  };
  std::vector<Ends> ends(gaps.count);
  for (const GapGrid::Run& run : grid.runs()) {
    gaps.runs.push_back({static_cast<std::int16_t>(run.y), static_cast<std::int16_t>(run.first),
                         static_cast<std::int16_t>(run.last), static_cast<std::uint16_t>(run.gap)});
    Ends& e = ends[static_cast<std::size_t>(run.gap)];
    for (int x = run.first; x <= run.last; ++x) {
      if (!grid.isCenter(x, run.y)) continue;
      const bool outer[4] = {!e.any, !e.any || x < e.x[1], !e.any || x > e.x[2], true};
      for (int k = 0; k < 4; ++k) {
        if (!outer[k]) continue;
        e.x[k] = x;
        e.y[k] = run.y;
      }
      e.any = true;
    }
  }
  for (std::uint16_t gap = 0; gap < gaps.count; ++gap) {
    for (int k = 0; ends[gap].any && k < 4; ++k) {
      gaps.ends.push_back({static_cast<float>(grid.middle(ends[gap].x[k])),
                           static_cast<float>(grid.middle(ends[gap].y[k])), gap});
    }
  }
  return gaps;
}

std::size_t
joinChains(const SLIMSurface& surface, int threads, std::vector<LeafGaps>& leaves)
{
  std::vector<std::uint32_t> surfels, first_gap(leaves.size() + 1, 0);
  std::vector<std::uint32_t> place(surface.size());
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    surfels.push_back(leaves[k].surfel);
    place[leaves[k].surfel] = static_cast<std::uint32_t>(k);
    first_gap[k + 1] = first_gap[k] + leaves[k].count;
  }
  const auto edges = overlapGraph(surface, surfels, threads);
  std::vector<std::vector<Join>> joins(edges.size());
  parallelFor(edges.size(), threads, 1, [&](std::size_t list, int) {
    for (const OverlapEdge& edge : edges[list]) {
      const std::size_t a = place[edge.a], b = place[edge.b];
      addJoins(surface, leaves[a], first_gap[a], leaves[b], first_gap[b], joins[list]);
      addJoins(surface, leaves[b], first_gap[b], leaves[a], first_gap[a], joins[list]);
    }
  });
  GapSets sets(first_gap.back());
  for (const auto& list : joins) {
    for (const auto& [a, b] : list) sets.join(a, b);
  }
  std::vector<std::uint32_t> number(first_gap.back());
  std::uint32_t chains = 0;
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    leaves[k].chain.resize(leaves[k].count);
    for (std::uint32_t gap = 0; gap < leaves[k].count; ++gap) {
      const std::uint32_t own = first_gap[k] + gap, first = sets.find(own);
      number[own] = own == first ? chains++ : number[first];
      leaves[k].chain[gap] = number[own];
    }
  }
  return chains;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "octree/octree_grid.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "points/point_runs.h"

namespace pcl_slim::detail {

/** Lists points in the order of their runs, and the roots they lie in.
 *
 * RunOf: runOf(i) is the i-th run in the order of roots. Each slice of runs is written by one
 * thread, behind the points of those before it. */
template <typename RunOf>
class RunPlacement {
 public:
  /** joined: runs may hold several points; else each holds one. */
  RunPlacement(std::size_t runs, bool joined, const RunOf& run_of, int threads)
      : runs_(runs), joined_(joined), run_of_(run_of), threads_(threads)
  {
  }

  void write(AlignedVector<std::uint32_t>& order, std::vector<OctreeCloud::Root>& roots) const
  {
    const std::vector<std::size_t> places = placesOfSlices();
    order.resize(places.back());
    std::vector<std::vector<OctreeCloud::Root>> parts(places.size() - 1);
    octree_grid::forEachSlice(runs_, threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                parts[s] = list(begin, end, places[s], places[s + 1], order.data());
                              });
    roots.clear();
    for (const auto& part : parts) roots.insert(roots.end(), part.begin(), part.end());
    roots.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(order.size())});
  }

 private:
  /** Points before each slice of runs, and behind the last. */
  std::vector<std::size_t> placesOfSlices() const
  {
    constexpr std::size_t kSlice = octree_grid::kSlice;
    std::vector<std::size_t> places((runs_ + kSlice - 1) / kSlice + 1, 0);
    octree_grid::forEachSlice(runs_, threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                std::size_t points = joined_ ? 0 : end - begin;
                                for (std::size_t i = begin; i < end && joined_; ++i) {
                                  points += run_of_(i).count;
                                }
                                places[s + 1] = points;
                              });
    std::partial_sum(places.begin(), places.end(), places.begin());
    return places;
  }

  /** Lists the points of some runs from a place on. \return the roots that begin among them. */
  std::vector<OctreeCloud::Root> list(std::size_t begin, std::size_t end, std::size_t place,
                                      std::size_t last_place, std::uint32_t* order) const
  {
    std::vector<OctreeCloud::Root> roots;
    std::uint32_t* at = order + place;
    std::uint32_t* const last = order + last_place;
    std::uint64_t root = begin > 0 ? run_of_(begin - 1).root : ~run_of_(begin).root;
    for (std::size_t i = begin; i < end; ++i) {
      const PointRun run = run_of_(i);
      if (run.root != root) {
        roots.push_back({run.root, static_cast<std::uint32_t>(at - order)});
        root = run.root;
      }
      if (joined_) {
        at = run.list(at, last);
      } else {
        *at++ = run.first;
      }
    }
    return roots;
  }

  std::size_t runs_;
  bool joined_;
  const RunOf& run_of_;
  int threads_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief Points with a side. */
struct SidedPoints {
  std::vector<std::array<double, 3>> position;
  std::vector<std::array<float, 3>> normal;
  bool oriented = false;  ///< points that face apart do not count as near
};

/** \brief A maximal set of points of which no two are nearer than the spacing, ascending. The points are
 * taken in an order that the seed makes. O(points); the same for any number of threads. */
std::vector<std::uint32_t>
poissonSet(const SidedPoints& points, double spacing, std::uint64_t seed, int threads);

/** \brief Leaves out of a set so many as make it this large: those nearest to another, one of each pair
 * first. O(set). */
void
thinSet(const SidedPoints& points, double spacing, std::size_t count,
        std::vector<std::uint32_t>& set);

}  // namespace pcl_slim::detail

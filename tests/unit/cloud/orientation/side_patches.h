// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/detail/signed_graph.h"

/** \brief Patches of surfaces whose sides are known. */
namespace pcl_slim_test {

using pcl_slim::along;
using pcl_slim::cross;
using pcl_slim::length;
using pcl_slim::scaled;
using pcl_slim::subtract;
using pcl_slim::Vector3;
using pcl_slim::detail::SidePatch;
using pcl_slim::detail::SignedEdge;

/** Edges from each patch to its nearest ones, each pair once. */
inline std::vector<SignedEdge> nearestEdges(const std::vector<SidePatch>& patches,
                                            std::size_t neighbors = 8) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t j = 0; j < patches.size(); ++j) {
      if (j != i) near.emplace_back(length(subtract(patches[j].center, patches[i].center)), j);
    }
    const std::size_t count = std::min(neighbors, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t k = 0; k < count; ++k) pairs.push_back(std::minmax(i, near[k].second));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<SignedEdge> edges;
  for (const auto& [a, b] : pairs) edges.push_back(pcl_slim::detail::edgeBetween(patches, a, b));
  return edges;
}

inline void turnPatch(SidePatch& patch) {
  patch.normal = scaled(patch.normal, -1);
}

/** Turns a share of the patches at random. \return which are turned */
inline std::vector<bool> turnSome(std::vector<SidePatch>& patches, double share,
                                  std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<bool> turned(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    turned[i] = unit(random) < share;
    if (turned[i]) turnPatch(patches[i]);
  }
  return turned;
}

/** Adds a unit sphere about z, outward normals, evenly spread. \param[in] lowest z of its patches */
inline void addSpherePatches(std::size_t count, double lowest, std::vector<SidePatch>& patches) {
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (1 - lowest) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double turn = 2.399963229728653 * static_cast<double>(i), r = std::sqrt(1 - z * z);
    const Vector3 n{r * std::cos(turn), r * std::sin(turn), z};
    patches.push_back({n, n, 1});
  }
}

/** Adds a planar grid of unit cells, about a centre. \param[in] u, v unit */
inline void addGridPatches(const Vector3& center, const Vector3& u, const Vector3& v, int columns,
                           int rows, std::vector<SidePatch>& patches) {
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const Vector3 across = along(center, x + 0.5 - 0.5 * columns, u);
      patches.push_back({along(across, y + 0.5 - 0.5 * rows, v), cross(u, v), 1});
    }
  }
}

/** Adds a box about the origin, outward normals. */
inline void addBoxPatches(int x, int y, int z, std::vector<SidePatch>& patches) {
  const Vector3 ux{1, 0, 0}, uy{0, 1, 0}, uz{0, 0, 1};
  addGridPatches({0.5 * x, 0, 0}, uy, uz, y, z, patches);
  addGridPatches({-0.5 * x, 0, 0}, uz, uy, z, y, patches);
  addGridPatches({0, 0.5 * y, 0}, uz, ux, z, x, patches);
  addGridPatches({0, -0.5 * y, 0}, ux, uz, x, z, patches);
  addGridPatches({0, 0, 0.5 * z}, ux, uy, x, y, patches);
  addGridPatches({0, 0, -0.5 * z}, uy, ux, y, x, patches);
}

}  // namespace pcl_slim_test

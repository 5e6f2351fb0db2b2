// SPDX-License-Identifier: BSD-3-Clause
#include "upsampling.h"

#include <pcl/search/search.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "finite_points.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/filters/pcl_normals.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint64_t kAxisBits = 21;
constexpr double kMostVoxels = 2097151.0;  ///< along an axis: 21 bits

void makeUnique(std::vector<std::uint64_t>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

/** Dilates the set of voxels by a number of steps along an axis. */
void dilateAlong(int axis, int steps, std::vector<std::uint64_t>& keys) {
  const std::uint64_t step = std::uint64_t{1} << (kAxisBits * static_cast<std::uint64_t>(2 - axis));
  std::vector<std::uint64_t> wider;
  wider.reserve(keys.size() * static_cast<std::size_t>(2 * steps + 1));
  for (const std::uint64_t key : keys) {
    const std::uint64_t first = key - static_cast<std::uint64_t>(steps) * step;
    for (int k = 0; k <= 2 * steps; ++k)
      wider.push_back(first + static_cast<std::uint64_t>(k) * step);
  }
  makeUnique(wider);
  keys = std::move(wider);
}

/** A search among the points; null without any. */
pcl::search::Search<pcl::PointXYZ>::Ptr treeOf(const FinitePoints& points) {
  if (points.source.empty()) return nullptr;
  auto tree = makeSearch(points.points);
  tree->setSortedResults(false);
  return tree;
}

}  // namespace

std::vector<std::array<double, 2>> discGrid(double radius, double step) {
  std::vector<std::array<double, 2>> grid;
  for (std::size_t i = 0;; ++i) {
    const double u = static_cast<double>(i) * step - radius;
    if (u > radius) return grid;
    for (std::size_t j = 0;; ++j) {
      const double v = static_cast<double>(j) * step - radius;
      if (v > radius) break;
      if (u * u + v * v < radius * radius) grid.push_back({u, v});
    }
  }
}

std::vector<std::array<double, 2>> discSamples(std::size_t count, double radius,
                                               std::uint64_t seed) {
  SplitMix random{seed};
  std::vector<std::array<double, 2>> samples;
  while (samples.size() < count) {
    const double u = 2 * random.nextShare() - 1, v = 2 * random.nextShare() - 1;
    if (u * u + v * v <= 1) samples.push_back({radius * u, radius * v});
  }
  return samples;
}

Result<std::vector<Position>> dilatedVoxels(const CloudView& view, double edge, int dilations) {
  Bounds box;
  for (std::size_t i = 0; i < view.count(); ++i) {
    const Position p = view.position(view.inputIndex(i));
    if (isFinite(p)) box.add(p);
  }
  Position low = box.low;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] -= edge * (dilations + 1);
    if ((box.high[a] - low[a]) / edge + dilations + 2 > kMostVoxels) {
      return Error{ErrorCode::kBadArgument,
                   "there would be more than two million voxels along an axis: make them larger"};
    }
  }
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < view.count(); ++i) {
    const Position p = view.position(view.inputIndex(i));
    if (!isFinite(p)) continue;
    std::uint64_t key = 0;
    for (std::size_t a = 0; a < 3; ++a)
      key = key << kAxisBits | static_cast<std::uint64_t>((p[a] - low[a]) / edge);
    keys.push_back(key);
  }
  makeUnique(keys);
  for (int axis = 0; axis < 3 && dilations > 0; ++axis) dilateAlong(axis, dilations, keys);
  std::vector<Position> corners;
  constexpr std::uint64_t kMask = (std::uint64_t{1} << kAxisBits) - 1;
  for (const std::uint64_t key : keys) {
    Position p;
    for (std::size_t a = 0; a < 3; ++a)
      p[a] = low[a] + edge * static_cast<double>(key >> (kAxisBits * (2 - a)) & kMask);
    corners.push_back(p);
  }
  return corners;
}

std::vector<std::uint32_t> nearestPoints(const CloudView& view,
                                         const std::vector<Position>& places) {
  const FinitePoints points(view);
  const auto tree = treeOf(points);
  std::vector<std::uint32_t> nearest(places.size(), 0);
  pcl::Indices found;
  std::vector<float> distances;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (tree && tree->nearestKSearch(points.local(places[i]), 1, found, distances) > 0)
      nearest[i] = points.source[static_cast<std::size_t>(found.front())];
  }
  return nearest;
}

std::vector<std::uint32_t> countNeighbors(const CloudView& view, double radius) {
  const FinitePoints points(view);
  const auto tree = treeOf(points);
  std::vector<std::uint32_t> counts(view.count(), 0);
  pcl::Indices found;
  std::vector<float> distances;
  for (std::size_t i = 0; i < points.source.size(); ++i) {
    const int count = tree->radiusSearch((*points.points)[i], radius, found, distances);
    counts[points.source[i]] = static_cast<std::uint32_t>(count);
  }
  return counts;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "components/regions.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr double kSameSheet = 0.3;   ///< [r] sheets of one surface differ by no more
constexpr int kPatternSide = 9;      ///< places of a closed leaf along u and v
constexpr std::size_t kPlaces = 64;  ///< of an open leaf, and those that single regions need
constexpr std::size_t kTask = 64;    ///< leaves a thread takes at a time

/** Marks the nodes of a map that are connected to one by its number. */
void fillRegion(const TrimMap& map, int first, std::uint16_t number,
                std::vector<std::uint16_t>& of_node, std::vector<int>& open) {
  const int side = map.side;
  open.assign(1, first);
  of_node[static_cast<std::size_t>(first)] = number;
  while (!open.empty()) {
    const int x = open.back() % side, y = open.back() / side;
    open.pop_back();
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      if (u < 0 || v < 0 || u >= side || v >= side || !map.at(u, v)) continue;
      std::uint16_t& own = of_node[static_cast<std::size_t>(v * side + u)];
      if (own != 0) continue;
      own = number;
      open.push_back(v * side + u);
    }
  }
}

/** Numbers a map's regions from 1, nodes outside are 0. \return how many. */
std::uint32_t labelRegions(const TrimMap& map, std::vector<std::uint16_t>& of_node) {
  const int all = map.side * map.side;
  of_node.assign(static_cast<std::size_t>(all), 0);
  std::vector<int> open;
  std::uint32_t count = 0;
  for (int node = 0; node < all; ++node) {
    if (of_node[static_cast<std::size_t>(node)] != 0 || !map.at(node % map.side, node / map.side))
      continue;
    fillRegion(map, node, static_cast<std::uint16_t>(++count), of_node, open);
  }
  return count;
}

}  // namespace

Regions::Regions(const SLIMSurface& surface, int threads)
    : begin_(surface.size() + 1, 0), of_node_(surface.size()) {
  std::vector<std::uint32_t> counts(surface.size(), 0);
  parallelFor(surface.size(), threads, kTask, [&](std::size_t i, int) {
    if (!surface.isLeaf(i)) return;
    const TrimMap map = surface.trimMap(i);
    counts[i] = map.closed() ? 1 : labelRegions(map, of_node_[i]);
    if (counts[i] < 2) std::vector<std::uint16_t>().swap(of_node_[i]);
  });
  for (std::size_t i = 0; i < counts.size(); ++i) begin_[i + 1] = begin_[i] + counts[i];
}

Sheet::Sheet(const SLIMSurface& surface, const Regions& regions, std::uint32_t leaf)
    : regions_(&regions),
      leaf_(leaf),
      center_{surface.cx[leaf], surface.cy[leaf], surface.cz[leaf]},
      radius_(surface.radius[leaf]),
      frame_({surface.nx[leaf], surface.ny[leaf], surface.nz[leaf]}),
      degree_(surface.degree[leaf]),
      c_(surface.coefficientsOf(leaf)),
      map_(surface.trimMap(leaf)) {}

std::uint32_t Sheet::regionAt(const Vector3& place) const {
  const Vector3 offset = scaled(subtract(place, center_), 1 / radius_);
  if (!(dot(offset, offset) < 1)) return Regions::kOutside;
  const double u = dot(offset, frame_.u), v = dot(offset, frame_.v);
  const double beside = dot(offset, frame_.w) - evaluateHeight(degree_, c_, u, v);
  if (!(std::abs(beside) <= kSameSheet)) return Regions::kOutside;
  if (map_.closed()) return regions_->begin(leaf_);
  const double middle = 0.5 * (map_.side - 1);
  const int column = static_cast<int>(std::lround((u + 1) * middle));
  const int row = static_cast<int>(std::lround((v + 1) * middle));
  return map_.at(column, row) ? regions_->at(leaf_, row * map_.side + column) : Regions::kOutside;
}

void Sheet::placesOf(std::vector<SheetPlace>& places) const {
  places.clear();
  if (map_.closed()) {
    constexpr double kMiddle = 0.5 * (kPatternSide - 1);
    for (int k = 0; k < kPatternSide * kPatternSide; ++k)
      add((k % kPatternSide - kMiddle) / (kMiddle + 0.5),
          (k / kPatternSide - kMiddle) / (kMiddle + 0.5), regions_->begin(leaf_), places);
    return;
  }
  const double middle = 0.5 * (map_.side - 1);
  for (int k = 0; k < map_.side * map_.side; ++k) {
    const int column = k % map_.side, row = k / map_.side;
    if (map_.at(column, row))
      add(column / middle - 1, row / middle - 1, regions_->at(leaf_, k), places);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const SheetPlace& a, const SheetPlace& b) { return a.region < b.region; });
  const std::size_t step = (places.size() + kPlaces - 1) / kPlaces;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const bool is_first = k == 0 || places[k].region != places[k - 1].region;
    if (is_first || k % step == 0) places[kept++] = places[k];
  }
  places.resize(kept);
}

void Sheet::add(double u, double v, std::uint32_t region, std::vector<SheetPlace>& places) const {
  if (!(u * u + v * v < 1)) return;
  const double w = evaluateHeight(degree_, c_, u, v);
  if (!(u * u + v * v + w * w < 1)) return;
  const Vector3 foot = along(along(center_, radius_ * u, frame_.u), radius_ * v, frame_.v);
  places.push_back({along(foot, radius_ * w, frame_.w), region});
}

}  // namespace pcl_slim::detail

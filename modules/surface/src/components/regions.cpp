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
/// Effective points over those in a closed leaf's ball: .36 of points all over it, 1 of points next
/// to its centre. Small components are between these.
constexpr double kEffectiveShare = 0.6;
constexpr std::size_t kTask = 64;  ///< leaves a thread takes at a time

/** The nodes of an open leaf's map that are inside, and where its surface is in the ball: a map has
 * no meaning elsewhere, and connects nothing there. */
std::vector<bool> nodesInBall(const SLIMSurface& surface, std::size_t leaf) {
  const TrimMap map = surface.trimMap(leaf);
  const double middle = 0.5 * (map.side - 1);
  std::vector<bool> inside(static_cast<std::size_t>(map.side * map.side));
  for (int k = 0; k < map.side * map.side; ++k) {
    const int column = k % map.side, row = k / map.side;
    if (!map.at(column, row)) continue;
    const double u = column / middle - 1, v = row / middle - 1;
    const double w = evaluateHeight(surface.degree[leaf], surface.coefficientsOf(leaf), u, v);
    inside[static_cast<std::size_t>(k)] = u * u + v * v + w * w < 1;
  }
  return inside;
}

/** Marks the nodes of a map that are connected to one by its number. */
void fillRegion(const std::vector<bool>& inside, int side, int first, std::uint16_t number,
                std::vector<std::uint16_t>& of_node, std::vector<int>& open) {
  open.assign(1, first);
  of_node[static_cast<std::size_t>(first)] = number;
  while (!open.empty()) {
    const int x = open.back() % side, y = open.back() / side;
    open.pop_back();
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      if (u < 0 || v < 0 || u >= side || v >= side) continue;
      const auto node = static_cast<std::size_t>(v * side + u);
      if (!inside[node] || of_node[node] != 0) continue;
      of_node[node] = number;
      open.push_back(v * side + u);
    }
  }
}

/** Numbers a map's regions from 1, nodes elsewhere are 0. \return how many. */
std::uint32_t labelRegions(const std::vector<bool>& inside, int side,
                           std::vector<std::uint16_t>& of_node) {
  of_node.assign(inside.size(), 0);
  std::vector<int> open;
  std::uint32_t count = 0;
  for (std::size_t node = 0; node < inside.size(); ++node) {
    if (of_node[node] != 0 || !inside[node]) continue;
    fillRegion(inside, side, static_cast<int>(node), static_cast<std::uint16_t>(++count), of_node,
               open);
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
    counts[i] = map.closed() ? 1 : labelRegions(nodesInBall(surface, i), map.side, of_node_[i]);
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
      map_(surface.trimMap(leaf)),
      kernel_(surface.info.fit_kernel),
      effective_count_(surface.effective_count[leaf]) {}

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

double Sheet::numPoints(const std::vector<SheetPlace>& places) const {
  if (map_.closed()) return effective_count_ / kEffectiveShare;
  double sum = 0, squares = 0;
  for (const SheetPlace& place : places) {
    const Vector3 offset = scaled(subtract(place.position, center_), 1 / radius_);
    const double w = evaluateKernel(kernel_, dot(offset, offset));
    sum += w;
    squares += w * w;
  }
  const double effective_places = squares > 0 ? sum * sum / squares : 0;
  if (!(effective_places > 0)) return effective_count_;
  return effective_count_ * static_cast<double>(places.size()) / effective_places;
}

void Sheet::add(double u, double v, std::uint32_t region, std::vector<SheetPlace>& places) const {
  if (!(u * u + v * v < 1)) return;
  const double w = evaluateHeight(degree_, c_, u, v);
  if (!(u * u + v * v + w * w < 1)) return;
  const Vector3 foot = along(along(center_, radius_ * u, frame_.u), radius_ * v, frame_.v);
  places.push_back({along(foot, radius_ * w, frame_.w), region});
}

}  // namespace pcl_slim::detail

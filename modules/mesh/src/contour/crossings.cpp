// SPDX-License-Identifier: BSD-3-Clause
#include "contour/crossings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"

namespace pcl_slim::detail {

namespace {

std::uint64_t
keyOf(const std::uint32_t (&place)[3])
{
  return spreadBits(place[0]) << 2 | spreadBits(place[1]) << 1 | spreadBits(place[2]);
}

Vector3
placeOf(const CellTree& tree, std::uint64_t key)
{
  const std::uint32_t place[3] = {gatherBits(key >> 2), gatherBits(key >> 1), gatherBits(key)};
  return tree.corner(place);
}

/// Ends whose normals agree are of one sheet unless the distances, in edges, are out of all proportion;
/// polynomials err at corners that far off.
constexpr double kMostOfSheet = 2.5, kMostSumOfSheet = 3;
/// Others may be of two sheets: then the distances' sum is larger than the normals predict.
constexpr double kMostDistance = 1.5, kSlope = 1.3, kSlack = 0.6;

/** The crossing of an edge between a and b, which has the length given. \return false: there is none. */
bool
crossingOf(const SheetDistance& a, const SheetDistance& b, bool oriented, unsigned int axis,
           double edge, double& share, Vector3& normal)
{
  if (!a.known || !b.known) return false;
  const double cosine = static_cast<double>(a.normal[0]) * b.normal[0] +
                        static_cast<double>(a.normal[1]) * b.normal[1] +
                        static_cast<double>(a.normal[2]) * b.normal[2];
  const double turn = !oriented && cosine < 0 ? -1 : 1;
  const double fa = a.distance, fb = turn * b.distance;
  if ((fa < 0) == (fb < 0)) return false;
  const double sum = std::abs(fa) + std::abs(fb);
  const double slope = std::max(std::abs(a.normal[axis]), std::abs(b.normal[axis]));
  const bool agree = turn * cosine > 0;
  const double most_sum = agree ? kMostSumOfSheet : kSlope * slope + kSlack;
  const double most = agree ? kMostOfSheet : kMostDistance;
  if (std::max(std::abs(fa), std::abs(fb)) > most * edge || sum > most_sum * edge) return false;
  share = sum > 0 ? std::abs(fa) / sum : 0.5;
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = (1 - share) * a.normal[k] + share * turn * b.normal[k];
  }
  normal = normalized(normal);
  // The normal points from the inner end to the outer one.
  if ((fa < 0) != (normal[axis] > 0)) return std::abs(normal[axis]) < 0.5;
  return true;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>>
CornerValues::evaluate(const CellTree& tree, const std::vector<CellEdge>& edges)
{
  AlignedVector<std::uint64_t> ends(2 * edges.size());
  parallelFor(edges.size(), field_.threads, 4096, [&](std::size_t e, int) {
    std::uint32_t place[3] = {edges[e].low[0], edges[e].low[1], edges[e].low[2]};
    ends[2 * e] = keyOf(place);
    place[edges[e].axis] += CellTree::width(edges[e].depth);
    ends[2 * e + 1] = keyOf(place);
  });
  AlignedVector<std::uint32_t> order;
  sortByKey(ends, order, field_.threads);
  std::vector<std::uint64_t> keys(ends.begin(), ends.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  merge(tree, keys);
  std::vector<std::array<std::uint32_t, 2>> corners(edges.size());
  std::size_t at = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    while (keys_[at] != ends[i]) ++at;
    corners[order[i] / 2][order[i] % 2] = static_cast<std::uint32_t>(at);
  }
  return corners;
}

/** Adds corners to those known, and evaluates the new ones. */
void
CornerValues::merge(const CellTree& tree, const std::vector<std::uint64_t>& keys)
{
  std::vector<std::uint64_t> all;
  all.reserve(keys_.size() + keys.size());
  std::set_union(keys_.begin(), keys_.end(), keys.begin(), keys.end(), std::back_inserter(all));
  std::vector<SheetDistance> values(all.size());
  std::vector<std::uint32_t> missing;
  std::size_t old = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (old < keys_.size() && keys_[old] == all[i]) {
      values[i] = values_[old++];
    } else {
      missing.push_back(static_cast<std::uint32_t>(i));
    }
  }
  forProbeBlocks(field_, missing.size(),
                 [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
                   Vector3 places[SurfaceProbe::kMost] = {};
                   SheetDistance found[SurfaceProbe::kMost];
                   for (std::size_t i = 0; i < n; ++i) {
                     places[i] = placeOf(tree, all[missing[first + i]]);
                   }
                   probe.distances(places, n, found);
                   for (std::size_t i = 0; i < n; ++i) values[missing[first + i]] = found[i];
                 });
  keys_ = std::move(all);
  values_ = std::move(values);
}

void
findCrossings(const CellTree& tree, const std::vector<CellEdge>& edges,
              const std::vector<std::array<std::uint32_t, 2>>& ends,
              const std::vector<SheetDistance>& values, bool oriented,
              std::vector<EdgeCrossing>& crossings)
{
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const SheetDistance &a = values[ends[e][0]], &b = values[ends[e][1]];
    const CellEdge& edge = edges[e];
    double share = 0;
    EdgeCrossing made{};
    const double size = tree.size(edge.depth);
    if (!crossingOf(a, b, oriented, edge.axis, size, share, made.normal)) continue;
    made.position = tree.corner(edge.low);
    made.position[edge.axis] += share * size;
    made.size = static_cast<float>(size);
    std::copy(edge.cell, edge.cell + 4, made.cell);
    // Seen from the upper end the ring is counter-clockwise: right where that is outside.
    if (!(a.distance < 0)) std::swap(made.cell[1], made.cell[3]);
    crossings.push_back(made);
  }
}

}  // namespace pcl_slim::detail

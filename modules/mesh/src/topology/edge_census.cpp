// SPDX-License-Identifier: BSD-3-Clause
#include "topology/edge_census.h"

#include <algorithm>

namespace pcl_slim::detail {

namespace {

/** Ends of an edge, the lower first, and whether a face runs from the higher to the lower. */
struct HalfEdge {
  std::uint32_t low, high;
  bool back;

  bool sameEdge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<HalfEdge>
sortedHalfEdges(const MeshFaces& faces)
{
  std::vector<HalfEdge> edges;
  edges.reserve(faces.corners.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % corners.size()];
      edges.push_back({std::min(a, b), std::max(a, b), a > b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  return edges;
}

}  // namespace

void
countEdges(const MeshFaces& faces, std::uint64_t& disagreeing, std::uint64_t& nonmanifold)
{
  disagreeing = nonmanifold = 0;
  const std::vector<HalfEdge> edges = sortedHalfEdges(faces);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].sameEdge(edges[i])) ++end;
    nonmanifold += end - i > 2;
    disagreeing += end - i == 2 && edges[i].back == edges[i + 1].back;
  }
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "triangles/welding.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/** An edge of welded vertices that the plane cuts, low before high. */
using Edge = std::pair<std::uint32_t, std::uint32_t>;

/** The line in which the plane cuts a triangle: from one edge to another. */
struct Segment {
  std::uint32_t from, to;  ///< edges, by their places in a sorted list
};

/** A cut edge and its segments: one that ends there and one that begins, where triangles agree. */
struct CutEdge {
  std::uint32_t segments[2] = {kNone, kNone};
  std::uint32_t count = 0;  ///< more than two: lines end here
};

/** Segments linked by the edges that they share. */
class SectionLinks {
 public:
  SectionLinks(std::vector<Segment> segments, std::size_t edges)
      : segments_(std::move(segments)), edges_(edges), used_(segments_.size(), false) {
    for (std::uint32_t s = 0; s < segments_.size(); ++s) {
      for (const std::uint32_t e : {segments_[s].from, segments_[s].to}) {
        if (edges_[e].count < 2) edges_[e].segments[edges_[e].count] = s;
        ++edges_[e].count;
      }
    }
  }

  /** All lines as lists of edges; closed ones do not repeat the first. */
  std::vector<std::pair<std::vector<std::uint32_t>, bool>> lines();

 private:
  bool isEnd(std::uint32_t edge) const { return edges_[edge].count != 2; }
  std::uint32_t nextOf(std::uint32_t edge, std::uint32_t segment) const {
    const CutEdge& cut = edges_[edge];
    return cut.segments[0] == segment ? cut.segments[1] : cut.segments[0];
  }
  std::pair<std::vector<std::uint32_t>, bool> lineFrom(std::uint32_t edge, std::uint32_t segment);

  std::vector<Segment> segments_;
  std::vector<CutEdge> edges_;
  std::vector<bool> used_;
};

/** Follows a line from an edge through one of its segments. */
std::pair<std::vector<std::uint32_t>, bool> SectionLinks::lineFrom(std::uint32_t edge,
                                                                   std::uint32_t segment) {
  const bool forward = segments_[segment].from == edge;
  std::vector<std::uint32_t> line = {edge};
  bool closed = false;
  while (segment != kNone && !used_[segment]) {
    used_[segment] = true;
    const Segment& s = segments_[segment];
    edge = s.from == edge ? s.to : s.from;
    closed = edge == line.front() && !isEnd(edge);
    if (closed) break;
    line.push_back(edge);
    segment = isEnd(edge) ? kNone : nextOf(edge, segment);
  }
  // Lines run as their first segment does.
  if (!forward) std::reverse(line.begin() + (closed ? 1 : 0), line.end());
  return {std::move(line), closed};
}

std::vector<std::pair<std::vector<std::uint32_t>, bool>> SectionLinks::lines() {
  std::vector<std::pair<std::vector<std::uint32_t>, bool>> made;
  const auto from = [&](std::uint32_t edge, std::uint32_t segment) {
    if (!used_[segment]) made.push_back(lineFrom(edge, segment));
  };
  for (std::uint32_t s = 0; s < segments_.size(); ++s) {
    for (const std::uint32_t e : {segments_[s].from, segments_[s].to}) {
      if (isEnd(e)) from(e, s);
    }
  }
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    for (const std::uint32_t s : edges_[e].segments) {
      if (s != kNone && segments_[s].from == e) from(e, s);
    }
    for (const std::uint32_t s : edges_[e].segments) {
      if (s != kNone) from(e, s);
    }
  }
  std::stable_sort(made.begin(), made.end(), [](const auto& a, const auto& b) {
    return *std::min_element(a.first.begin(), a.first.end()) <
           *std::min_element(b.first.begin(), b.first.end());
  });
  return made;
}

}  // namespace

Result<SectionPlane> SectionPlane::through(const Vector3& place, const Vector3& normal) {
  if (!isFinite(place) || !isFinite(normal) || !(dot(normal, normal) > 0)) {
    return badInput("the section plane's normal is zero or not finite: give a direction");
  }
  SectionPlane plane;
  plane.normal = normalized(normal);
  plane.offset = dot(plane.normal, place);
  constexpr double kLevel = 0.999;
  const Vector3 upward = std::abs(plane.normal[2]) < kLevel ? Vector3{0, 0, 1} : Vector3{0, 1, 0};
  plane.up = normalized(along(upward, -dot(upward, plane.normal), plane.normal));
  plane.right = cross(plane.up, plane.normal);
  return plane;
}

Result<std::vector<SectionLine>> cutMesh(const TriangleMesh& mesh, const SectionPlane& plane) {
  if (Error error = checkCorners(mesh)) return error;
  const WeldedTriangles welded = weld(mesh);
  std::vector<std::uint32_t> first(welded.num_vertices, kNone);  // of the mesh's vertices
  std::vector<double> height(welded.num_vertices);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::uint32_t& own = first[welded.vertex[v]];
    if (own != kNone) continue;
    own = v;
    height[welded.vertex[v]] = dot(plane.normal, mesh.vertices[v]) - plane.offset;
  }
  // Of each triangle that the plane cuts, the edges at which the line enters and leaves: the part
  // above the plane is to the left of it as seen from outside of the mesh.
  std::vector<std::pair<Edge, Edge>> cuts;
  std::vector<Edge> edges;
  for (const Triangle& corners : welded.triangles) {
    Edge from{kNone, kNone}, to{kNone, kNone};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      const bool above = height[a] >= 0;
      if (above == (height[b] >= 0)) continue;
      (above ? from : to) = std::minmax(a, b);
    }
    if (from.first == kNone) continue;
    cuts.emplace_back(from, to);
    edges.push_back(from);
    edges.push_back(to);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto placeOf = [&](const Edge& e) {
    return static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), e) -
                                      edges.begin());
  };
  std::vector<Segment> segments;
  for (const auto& [from, to] : cuts) segments.push_back({placeOf(from), placeOf(to)});
  std::vector<SectionLine> lines;
  for (const auto& [line, closed] : SectionLinks(std::move(segments), edges.size()).lines()) {
    SectionLine made;
    made.closed = closed;
    for (const std::uint32_t e : line) {
      const auto [low, high] = edges[e];
      const double share = height[low] / (height[low] - height[high]);
      const Vector3 &a = mesh.vertices[first[low]], &b = mesh.vertices[first[high]];
      made.points.push_back(along(a, share, subtract(b, a)));
      made.edge.push_back({first[low], first[high]});
      made.share.push_back(share);
    }
    lines.push_back(std::move(made));
  }
  return lines;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "vertices/surface_vertices.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

constexpr double kSharpCosine = 0.766;  ///< 40 degrees: faces that part by more meet in an edge
constexpr double kMostMove =
    0.7;  ///< edges that an edge's middle moves: half of one at right angles
constexpr int kMedianPasses = 2, kFollowPasses = 2;
constexpr int kSteps = 3;  ///< of a vertex's way onto two or three curved faces
constexpr std::uint32_t kNone = 0xffffffffu;

/** A vertex to be made where the faces under two or three others meet. */
struct Meeting {
  std::uint32_t at[3];
  std::size_t count;
  Vector3 place;  ///< the middle first, then where the faces meet
  Vector3 normal{};
  double most;  ///< how far the place may be from the middle
  bool found = false;
};

/** The vertices next to each vertex. */
struct Rings {
  std::vector<std::uint32_t> begin, neighbours;

  Rings(const EdgeTable& table, std::size_t vertices)
      : begin(vertices + 2, 0), neighbours(2 * table.edges.size()) {
    for (const MeshEdge& edge : table.edges) {
      ++begin[edge.low + 2];
      ++begin[edge.high + 2];
    }
    for (std::size_t v = 2; v < begin.size(); ++v) begin[v] += begin[v - 1];
    for (const MeshEdge& edge : table.edges) {
      neighbours[begin[edge.low + 1]++] = edge.high;
      neighbours[begin[edge.high + 1]++] = edge.low;
    }
  }
};

/** Vertices on the edges of a triangle, from its corner k to the next, or kNone. */
using Middles = std::array<std::uint32_t, 3>;

class Sharpening {
 public:
  Sharpening(const SLIMSurface& sharp, int threads, std::vector<Triangle>& triangles,
             SurfaceVertices& vertices, MeshStatistics& statistics)
      : index_(sharp, ProbeUse::kSharp),
        field_{index_, 0, threads},
        triangles_(triangles),
        vertices_(vertices),
        statistics_(statistics) {}

  void run() {
    measureEdges();
    moveVertices();
    const EdgeTable table(triangles_, field_.threads);
    const std::vector<std::uint32_t> made = addEdges(table);
    divide(table, made);
  }

 private:
  void measureEdges();
  void faceNearest();
  void moveVertices();
  void takeMedianSides(const Rings& ring);
  void followNeighbours(const Rings& ring);
  std::vector<std::uint32_t> addEdges(const EdgeTable& table);
  void meet(std::vector<Meeting>& meetings);
  void meetFaces(SurfaceProbe& probe, Meeting& own) const;
  std::uint32_t addVertex(const Meeting& meeting);
  void divide(const EdgeTable& table, const std::vector<std::uint32_t>& made);
  std::vector<std::uint32_t> addCorners(const std::vector<Middles>& middles);
  void divideTwo(const Triangle& t, const Middles& middle, std::vector<Triangle>& made) const;
  void divideTriangle(const Triangle& t, const Middles& middle, std::vector<Triangle>& made) const;

  bool isSharp(std::uint32_t a, std::uint32_t b) const {
    return vertices_.supported[a] != 0 && vertices_.supported[b] != 0 &&
           dot(vertices_.normal[a], vertices_.normal[b]) < kSharpCosine;
  }

  ProbeIndex index_;
  ProbeField field_;
  std::vector<Triangle>& triangles_;
  SurfaceVertices& vertices_;
  MeshStatistics& statistics_;
};

/** The longest edge about each vertex as its size, and the margin of probes. */
void Sharpening::measureEdges() {
  std::fill(vertices_.size.begin(), vertices_.size.end(), 0.0f);
  for (const Triangle& t : triangles_) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto edge =
          static_cast<float>(length(subtract(vertices_.position[a], vertices_.position[b])));
      vertices_.size[a] = std::max(vertices_.size[a], edge);
      vertices_.size[b] = std::max(vertices_.size[b], edge);
    }
  }
  field_.margin = 2.0 * median(vertices_.size);
}

/** Turns vertices to the side of the nearest face. */
void Sharpening::faceNearest() {
  forProbeBlocks(field_, vertices_.count(),
                 [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
                   SheetDistance near[SurfaceProbe::kMost];
                   probe.distances(vertices_.position.data() + first, n, near);
                   for (std::size_t i = 0; i < n; ++i) {
                     const auto& side = near[i].normal;
                     if (near[i].known) vertices_.normal[first + i] = {side[0], side[1], side[2]};
                   }
                 });
}

/** Puts vertices onto the nearest face. */
void Sharpening::moveVertices() {
  faceNearest();
  const std::vector<Vector3> own = vertices_.normal;
  const Rings rings(EdgeTable(triangles_, field_.threads), own.size());
  for (int pass = 0; pass < kMedianPasses; ++pass) takeMedianSides(rings);
  std::vector<std::uint32_t> which(own.size());
  std::fill(vertices_.supported.begin(), vertices_.supported.end(), 0);
  std::iota(which.begin(), which.end(), 0u);
  putOnSurface(field_, which, vertices_);
  // At a corner the faces around may have outvoted the nearest one, and be too far away.
  which.clear();
  for (std::uint32_t v = 0; v < own.size(); ++v) {
    if (vertices_.supported[v] != 0) continue;
    vertices_.normal[v] = own[v];
    which.push_back(v);
  }
  putOnSurface(field_, which, vertices_);
  for (int pass = 0; pass < kFollowPasses; ++pass) followNeighbours(rings);
}

/** Brings vertices that no leaf reaches, as edges are rounded off most there, onto the nearest
 * plane of those next to them, and from there onto the surface. */
void Sharpening::followNeighbours(const Rings& ring) {
  std::vector<std::uint32_t> which;
  std::vector<Vector3> before;
  const std::vector<std::uint8_t> supported = vertices_.supported;
  for (std::uint32_t v = 0; v < supported.size(); ++v) {
    if (supported[v] != 0) continue;
    const Vector3 place = vertices_.position[v];
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = ring.begin[v]; i < ring.begin[v + 1]; ++i) {
      const std::uint32_t o = ring.neighbours[i];
      if (supported[o] == 0) continue;
      const Vector3& normal = vertices_.normal[o];
      const double off = dot(normal, subtract(place, vertices_.position[o]));
      if (!(std::abs(off) < least)) continue;
      least = std::abs(off);
      vertices_.position[v] = along(place, -off, normal);
      vertices_.normal[v] = normal;
    }
    if (!(least < vertices_.size[v])) {
      vertices_.position[v] = place;
      continue;
    }
    which.push_back(v);
    before.push_back(place);
  }
  putOnSurface(field_, which, vertices_);
  for (std::size_t i = 0; i < which.size(); ++i)
    if (vertices_.supported[which[i]] == 0) vertices_.position[which[i]] = before[i];
}

/** Gives each vertex that side among its own and its neighbours' which agrees best with all of
 * them: lone vertices join the face around them, and edges between faces stay. */
void Sharpening::takeMedianSides(const Rings& ring) {
  const std::vector<Vector3> sides = vertices_.normal;
  parallelFor(sides.size(), field_.threads, 1024, [&](std::size_t v, int) {
    const std::uint32_t *first = ring.neighbours.data() + ring.begin[v],
                        *last = ring.neighbours.data() + ring.begin[v + 1];
    double least = std::numeric_limits<double>::infinity();
    const auto judge = [&](const Vector3& side) {
      double sum = length(subtract(side, sides[v]));
      for (const std::uint32_t* o = first; o != last; ++o) sum += length(subtract(side, sides[*o]));
      if (!(sum < least)) return;
      least = sum;
      vertices_.normal[v] = side;
    };
    judge(sides[v]);
    for (const std::uint32_t* o = first; o != last; ++o) judge(sides[*o]);
  });
}

/** Puts planes on the faces under a place. */
void planesAt(SurfaceProbe& probe, const Vector3& place, std::size_t count, Plane* planes) {
  Vector3 places[3], sides[3];
  ProbeSample samples[3];
  for (std::size_t k = 0; k < count; ++k) {
    places[k] = place;
    sides[k] = planes[k].normal;
  }
  ProbeRequest request;
  request.positions = places;
  request.sides = sides;
  request.count = count;
  request.curvature = false;
  probe.evaluate(request, samples);
  for (std::size_t k = 0; k < count; ++k) {
    if (samples[k].supported) planes[k] = {samples[k].position, samples[k].normal};
  }
}

/** Brings vertices to where the faces on which others are meet. */
void Sharpening::meet(std::vector<Meeting>& meetings) {
  forProbeBlocks(field_, meetings.size(),
                 [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
                   for (std::size_t i = first; i < first + n; ++i) meetFaces(probe, meetings[i]);
                 });
}

void Sharpening::meetFaces(SurfaceProbe& probe, Meeting& own) const {
  Plane planes[3];
  for (std::size_t k = 0; k < own.count; ++k) {
    planes[k] = {vertices_.position[own.at[k]], vertices_.normal[own.at[k]]};
  }
  Vector3 place;
  if (!meetingOf(planes, own.count, own.place, place)) return;
  for (int step = 1; step < kSteps; ++step) {
    planesAt(probe, place, own.count, planes);
    if (!meetingOf(planes, own.count, own.place, place)) return;
  }
  if (length(subtract(place, own.place)) > own.most) return;
  own.place = place;
  own.found = true;
  for (std::size_t k = 0; k < own.count; ++k) own.normal = along(own.normal, 1, planes[k].normal);
}

std::uint32_t Sharpening::addVertex(const Meeting& meeting) {
  const auto v = static_cast<std::uint32_t>(vertices_.count());
  vertices_.resize(v + 1);
  vertices_.position[v] = meeting.place;
  vertices_.normal[v] = normalized(meeting.normal);
  return v;
}

/** Adds vertices on sharp edges. \return of each edge of the mesh the vertex that divides it, or
 * kNone. */
std::vector<std::uint32_t> Sharpening::addEdges(const EdgeTable& table) {
  std::vector<Meeting> meetings;
  std::vector<std::uint32_t> edges;
  for (std::uint32_t e = 0; e < table.edges.size(); ++e) {
    const MeshEdge& edge = table.edges[e];
    if (!isSharp(edge.low, edge.high)) continue;
    const Vector3 &a = vertices_.position[edge.low], &b = vertices_.position[edge.high];
    Meeting own{{edge.low, edge.high, 0}, 2, scaled(along(a, 1, b), 0.5), {}, 0};
    own.most = kMostMove * length(subtract(a, b));
    meetings.push_back(own);
    edges.push_back(e);
  }
  meet(meetings);
  std::vector<std::uint32_t> made(table.edges.size(), kNone);
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    if (!meetings[i].found) continue;
    made[edges[i]] = addVertex(meetings[i]);
    ++statistics_.edge_vertices;
  }
  return made;
}

/** Divides a triangle of which one edge, from a to b, is whole. */
void Sharpening::divideTwo(const Triangle& t, const Middles& middle,
                           std::vector<Triangle>& made) const {
  const std::size_t whole =
      static_cast<std::size_t>(std::find(middle.begin(), middle.end(), kNone) - middle.begin());
  const std::uint32_t a = t[whole], b = t[(whole + 1) % 3], tip = t[(whole + 2) % 3];
  const std::uint32_t at_b = middle[(whole + 1) % 3], at_a = middle[(whole + 2) % 3];
  const auto lengthOf = [&](std::uint32_t v, std::uint32_t w) {
    return length(subtract(vertices_.position[v], vertices_.position[w]));
  };
  made.push_back({tip, at_a, at_b});
  if (lengthOf(a, at_b) < lengthOf(b, at_a)) {
    made.push_back({a, b, at_b});
    made.push_back({a, at_b, at_a});
  } else {
    made.push_back({a, b, at_a});
    made.push_back({b, at_b, at_a});
  }
}

/** Replaces a triangle by those between the vertices on its edges. */
void Sharpening::divideTriangle(const Triangle& t, const Middles& middle,
                                std::vector<Triangle>& made) const {
  switch (std::count(middle.begin(), middle.end(), kNone)) {
    case 3: return made.push_back(t);
    case 1: return divideTwo(t, middle, made);
    case 0: made.push_back(middle); break;
    default: break;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t before = middle[(k + 2) % 3], after = middle[k];
    if (before != kNone && after != kNone) made.push_back({t[k], after, before});
    if (before != kNone || after == kNone) continue;
    made.push_back({t[k], after, t[(k + 2) % 3]});
    made.push_back({after, t[(k + 1) % 3], t[(k + 2) % 3]});
  }
}

/** Adds vertices where three faces meet. \return of each triangle its vertex inside, or kNone. */
std::vector<std::uint32_t> Sharpening::addCorners(const std::vector<Middles>& middles) {
  std::vector<Meeting> meetings;
  std::vector<std::uint32_t> corners(triangles_.size(), kNone), of;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const Middles& m = middles[t];
    if (std::count(m.begin(), m.end(), kNone) > 0) continue;
    const Triangle& own = triangles_[t];
    Meeting meeting{{own[0], own[1], own[2]}, 3, {}, {}, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      meeting.place = along(meeting.place, 1 / 3.0, vertices_.position[m[k]]);
      meeting.most = std::max<double>(meeting.most, vertices_.size[own[k]]);
    }
    meetings.push_back(meeting);
    of.push_back(t);
  }
  meet(meetings);
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    if (!meetings[i].found) continue;
    corners[of[i]] = addVertex(meetings[i]);
    ++statistics_.corner_vertices;
  }
  return corners;
}

/** Divides triangles at the vertices made on their edges and inside them. */
void Sharpening::divide(const EdgeTable& table, const std::vector<std::uint32_t>& made) {
  std::vector<Middles> middles(triangles_.size(), {kNone, kNone, kNone});
  for (std::size_t e = 0; e < table.edges.size(); ++e) {
    for (std::uint32_t i = 0; i < table.edges[e].count; ++i) {
      const std::uint32_t use = table.uses[table.edges[e].first + i];
      middles[use / 3][use % 3] = made[e];
    }
  }
  const std::vector<std::uint32_t> corners = addCorners(middles);
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& own = triangles_[t];
    if (corners[t] == kNone) {
      divideTriangle(own, middles[t], triangles);
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      triangles.push_back({corners[t], own[k], middles[t][k]});
      triangles.push_back({corners[t], middles[t][k], own[(k + 1) % 3]});
    }
  }
  triangles_ = std::move(triangles);
}

}  // namespace

bool meetingOf(const Plane* planes, std::size_t count, const Vector3& near, Vector3& place) {
  constexpr double kLeastDeterminant = 1e-2;  ///< of unit normals' products: 6 degrees for two
  Eigen::Matrix3d products = Eigen::Matrix3d::Identity();
  Eigen::Vector3d distances = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    distances[row] = dot(planes[i].normal, subtract(planes[i].place, near));
    for (std::size_t j = 0; j < count; ++j) {
      products(row, static_cast<Eigen::Index>(j)) = dot(planes[i].normal, planes[j].normal);
    }
  }
  if (!(std::abs(products.determinant()) > kLeastDeterminant)) return false;
  const Eigen::Vector3d steps = products.inverse() * distances;
  place = near;
  for (std::size_t i = 0; i < count; ++i) {
    place = along(place, steps[static_cast<Eigen::Index>(i)], planes[i].normal);
  }
  return true;
}

void sharpen(const SLIMSurface& sharp, int threads, std::vector<Triangle>& triangles,
             SurfaceVertices& vertices, MeshStatistics& statistics) {
  Sharpening(sharp, threads, triangles, vertices, statistics).run();
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "borders/borders.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"

namespace pcl_slim::detail {

void markUncovered(const ProbeField& field, double threshold, SurfaceVertices& vertices) {
  forProbeBlocks(
      field, vertices.count(), [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
        for (std::size_t v = first; v < first + n; ++v) {
          const ProbeScale scale = probe.scaleAt(vertices.position[v], vertices.normal[v]);
          if (vertices.supported[v] == 0 || scale.coverage < threshold) {
            vertices.outside[v] = 1;
          }
        }
      });
}

namespace {

constexpr float kBorder = 0.5f;  ///< of SurfaceVertices::outside
constexpr int kSteps = 4;        ///< of false position along an edge
constexpr double kSnap = 0.25;  ///< of an edge: a vertex that near to the border is brought onto it

enum class Side : std::uint8_t { kInside, kOn, kOutside };

/** An edge that the border crosses. */
struct Cut {
  std::uint32_t inner, outer;
  double share = 0;  ///< of the edge, from the inner end
  std::uint32_t vertex = 0;
};

bool isOutside(const SurfaceVertices& vertices, std::uint32_t v) {
  return vertices.outside[v] > kBorder;
}

std::vector<Cut> cutsOf(const EdgeTable& table, const SurfaceVertices& vertices) {
  std::vector<Cut> cuts;
  for (const MeshEdge& edge : table.edges) {
    const bool low = isOutside(vertices, edge.low);
    if (low == isOutside(vertices, edge.high)) continue;
    Cut cut;
    cut.inner = low ? edge.high : edge.low;
    cut.outer = low ? edge.low : edge.high;
    cuts.push_back(cut);
  }
  return cuts;
}

/** An end of the part of an edge in which the border is. */
struct Bracket {
  double share, value;  ///< value: how far inside
};

/** Finds where on their edges the border is: false position, with steps that keep both ends moving
 * (Illinois). Vertices first + i are the places found, on the surface. */
void findBorder(const ProbeField& field, std::size_t first, std::vector<Cut>& cuts,
                SurfaceVertices& vertices) {
  const std::size_t n = cuts.size();
  std::vector<Bracket> in(n), out(n);
  std::vector<std::uint32_t> which(n);
  for (std::size_t i = 0; i < n; ++i) {
    in[i] = {0, std::max(1e-3, 0.5 - vertices.outside[cuts[i].inner])};
    out[i] = {1, std::min(-1e-3, 0.5 - vertices.outside[cuts[i].outer])};
    which[i] = static_cast<std::uint32_t>(first + i);
  }
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t i = 0; i < n; ++i) {
      Cut& cut = cuts[i];
      const double t = in[i].value / (in[i].value - out[i].value);
      cut.share = in[i].share + t * (out[i].share - in[i].share);
      const Vector3 &p = vertices.position[cut.inner], &q = vertices.position[cut.outer];
      vertices.position[first + i] = along(p, cut.share, subtract(q, p));
      vertices.normal[first + i] =
          normalized(along(vertices.normal[cut.inner], cut.share,
                           subtract(vertices.normal[cut.outer], vertices.normal[cut.inner])));
      vertices.size[first + i] = std::max(vertices.size[cut.inner], vertices.size[cut.outer]);
      vertices.outside[first + i] = kBorder;
    }
    putOnSurface(field, which, vertices);
    for (std::size_t i = 0; i < n; ++i) {
      const double value = 0.5 - vertices.outside[first + i];
      if (value >= 0) {
        in[i] = {cuts[i].share, std::max(value, 1e-6)};
        out[i].value *= 0.5;
      } else {
        out[i] = {cuts[i].share, value};
        in[i].value *= 0.5;
      }
    }
  }
}

/** The vertex on the edge between an inner and an outer vertex. */
std::uint32_t cutAt(const std::vector<Cut>& cuts, std::uint32_t a, std::uint32_t b) {
  const auto key = [](std::uint32_t p, std::uint32_t q) {
    return static_cast<std::uint64_t>(std::min(p, q)) << 32 | std::max(p, q);
  };
  return std::lower_bound(
             cuts.begin(), cuts.end(), key(a, b),
             [&](const Cut& cut, std::uint64_t k) { return key(cut.inner, cut.outer) < k; })
      ->vertex;
}

/** Brings vertices next to the border onto it. */
void snap(const std::vector<Cut>& cuts, std::vector<Side>& sides, SurfaceVertices& vertices) {
  std::vector<double> nearest(sides.size(), kSnap);
  std::vector<std::uint32_t> target(sides.size(), 0);
  for (const Cut& cut : cuts) {
    if (cut.share < nearest[cut.inner]) {
      nearest[cut.inner] = cut.share;
      target[cut.inner] = cut.vertex;
    }
    if (1 - cut.share < nearest[cut.outer]) {
      nearest[cut.outer] = 1 - cut.share;
      target[cut.outer] = cut.vertex;
    }
  }
  for (std::size_t v = 0; v < sides.size(); ++v) {
    if (!(nearest[v] < kSnap)) continue;
    const std::uint32_t to = target[v];
    sides[v] = Side::kOn;
    vertices.position[v] = vertices.position[to];
    vertices.normal[v] = vertices.normal[to];
    vertices.k1[v] = vertices.k1[to];
    vertices.k2[v] = vertices.k2[to];
    vertices.outside[v] = kBorder;
    vertices.on_border[v] = 1;
  }
}

class Cutter {
 public:
  Cutter(const std::vector<Cut>& cuts, const std::vector<Side>& sides,
         const SurfaceVertices& vertices)
      : cuts_(cuts), sides_(sides), vertices_(vertices) {}

  /** Appends what stays of a triangle. */
  void add(const Triangle& t, std::vector<Triangle>& made) const {
    std::size_t inside = 0, outside = 0, first_inside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      inside += sides_[t[k]] == Side::kInside ? 1 : 0;
      outside += sides_[t[k]] == Side::kOutside ? 1 : 0;
    }
    if (inside == 0 && !(outside == 0 && mostlyInside(t))) return;
    if (outside == 0) {
      made.push_back(t);
      return;
    }
    // Walk around from an inner corner; what is left is a fan about it.
    while (sides_[t[first_inside]] != Side::kInside) ++first_inside;
    std::uint32_t polygon[5];
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[(first_inside + k) % 3], b = t[(first_inside + k + 1) % 3];
      if (sides_[a] != Side::kOutside) polygon[count++] = a;
      if (sides_[a] != Side::kOn && sides_[b] != Side::kOn && sides_[a] != sides_[b]) {
        polygon[count++] = cutAt(cuts_, a, b);
      }
    }
    for (std::size_t k = 2; k < count; ++k)
      made.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }

 private:
  bool mostlyInside(const Triangle& t) const {
    int outer = 0;
    for (const std::uint32_t v : t) outer += isOutside(vertices_, v) ? 1 : 0;
    return outer < 2;
  }

  const std::vector<Cut>& cuts_;
  const std::vector<Side>& sides_;
  const SurfaceVertices& vertices_;
};

constexpr double kBendShare = 0.15;  ///< of the points' spacing: the border is no finer than that
constexpr double kBendReach = 0.5;   ///< of an edge: how far the border is sought from its middle
constexpr double kBendDepth = 0.7;   ///< of a triangle's height: no deeper

/** An edge on the trimmed border, with what is evaluated next to its middle. */
struct BorderEdge {
  std::uint32_t use;    ///< 3 t + k: triangle t from its corner k to the next
  double reach, depth;  ///< how far the border is sought outside and inside
  Vector3 outwards;
  std::uint32_t middle = 0, end = 0;  ///< vertices: the edge's middle, the end of the reach

  std::uint32_t corner(const std::vector<Triangle>& triangles, std::uint32_t k) const {
    return triangles[use / 3][(use % 3 + k) % 3];
  }
};

std::vector<BorderEdge> trimmedEdges(const std::vector<Triangle>& triangles, int threads,
                                     const SurfaceVertices& vertices) {
  // An edge whose ends are on the border has all its triangles among those with two such corners.
  std::vector<Triangle> near;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    int ends = 0;
    for (const std::uint32_t v : triangles[t]) ends += vertices.on_border[v];
    if (ends < 2) continue;
    near.push_back(triangles[t]);
    numbers.push_back(t);
  }
  std::vector<BorderEdge> edges;
  const EdgeTable table(near, threads);
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 1 || vertices.on_border[edge.low] == 0 || vertices.on_border[edge.high] == 0)
      continue;
    BorderEdge made{};
    const std::uint32_t use = table.uses[edge.first];
    made.use = 3 * numbers[use / 3] + use % 3;
    const Vector3& a = vertices.position[made.corner(triangles, 0)];
    const Vector3 ab = subtract(vertices.position[made.corner(triangles, 1)], a);
    const Vector3 area = cross(ab, subtract(vertices.position[made.corner(triangles, 2)], a));
    const double size = length(ab), height = length(area) / size;
    if (!(size > 0) || !(height > 0)) continue;
    made.reach = kBendReach * size;
    made.depth = std::min(made.reach, kBendDepth * height);
    made.outwards = normalized(cross(ab, area));
    edges.push_back(made);
  }
  return edges;
}

/** Evaluates the surface at the edges' middles, and at the end of the reach on the side where the
 * border is. Vertices are added. */
void probeEdges(const ProbeField& field, const std::vector<Triangle>& triangles,
                std::vector<BorderEdge>& edges, SurfaceVertices& vertices) {
  auto next = static_cast<std::uint32_t>(vertices.count());
  vertices.resize(next + 2 * edges.size());
  std::vector<std::uint32_t> middles, ends;
  for (BorderEdge& edge : edges) {
    middles.push_back(edge.middle = next++);
    ends.push_back(edge.end = next++);
    const std::uint32_t a = edge.corner(triangles, 0), b = edge.corner(triangles, 1);
    for (const std::uint32_t v : {edge.middle, edge.end}) {
      vertices.position[v] = along(scaled(vertices.position[a], 0.5), 0.5, vertices.position[b]);
      vertices.normal[v] = normalized(along(vertices.normal[a], 1, vertices.normal[b]));
      vertices.size[v] = std::max(vertices.size[a], vertices.size[b]);
      vertices.outside[v] = kBorder;
    }
  }
  putOnSurface(field, middles, vertices);
  for (const BorderEdge& edge : edges) {
    const double way = isOutside(vertices, edge.middle) ? -edge.depth : edge.reach;
    vertices.position[edge.end] = along(vertices.position[edge.middle], way, edge.outwards);
  }
  putOnSurface(field, ends, vertices);
}

/** Whether the two parts of a triangle face the way it does. */
bool faceAlike(const Triangle& first, const Triangle& second, const Triangle& whole,
               const SurfaceVertices& vertices) {
  const auto area = [&](const Triangle& t) {
    const Vector3& p = vertices.position[t[0]];
    return cross(subtract(vertices.position[t[1]], p), subtract(vertices.position[t[2]], p));
  };
  return dot(area(first), area(whole)) > 0 && dot(area(second), area(whole)) > 0;
}

/** Divides edges of the border whose middle is farther from where the data end than the tolerance
 * and than a share of the spacing. */
void bendBorder(const ProbeField& field, double tolerance, std::vector<Triangle>& triangles,
                SurfaceVertices& vertices) {
  std::vector<BorderEdge> edges = trimmedEdges(triangles, field.threads, vertices);
  probeEdges(field, triangles, edges, vertices);
  edges.erase(std::remove_if(edges.begin(), edges.end(),
                             [&](const BorderEdge& edge) {
                               return isOutside(vertices, edge.middle) ==
                                      isOutside(vertices, edge.end);
                             }),
              edges.end());
  std::vector<Cut> cuts(edges.size());
  std::vector<std::uint32_t> middles;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool outside = isOutside(vertices, edges[i].middle);
    cuts[i].inner = outside ? edges[i].end : edges[i].middle;
    cuts[i].outer = outside ? edges[i].middle : edges[i].end;
    middles.push_back(edges[i].middle);
  }
  const auto first = static_cast<std::uint32_t>(vertices.count());
  vertices.resize(first + edges.size());
  findBorder(field, first, cuts, vertices);
  const std::vector<double> densities = densitiesAt(field, middles, vertices);
  std::vector<bool> divided(triangles.size(), false);
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const std::uint32_t t = edges[i].use / 3;
    const double off =
        length(subtract(vertices.position[first + i], vertices.position[edges[i].middle]));
    if (divided[t] || !(off > tolerance) || !(densities[i] * off * off > kBendShare * kBendShare))
      continue;
    const std::uint32_t c = edges[i].corner(triangles, 2);
    const Triangle begin = {edges[i].corner(triangles, 0), first + i, c};
    const Triangle rest = {first + i, edges[i].corner(triangles, 1), c};
    if (!faceAlike(begin, rest, triangles[t], vertices)) continue;
    triangles[t] = begin;
    triangles.push_back(rest);
    vertices.on_border[first + i] = 1;
    divided[t] = true;
  }
}

}  // namespace

void trimAtBorder(const ProbeField& field, double tolerance, std::vector<Triangle>& triangles,
                  SurfaceVertices& vertices) {
  const std::size_t count = vertices.count();
  const EdgeTable table(triangles, field.threads);
  std::vector<Cut> cuts = cutsOf(table, vertices);
  vertices.resize(count + cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    cuts[i].vertex = static_cast<std::uint32_t>(count + i);
  }
  findBorder(field, count, cuts, vertices);
  std::fill(vertices.on_border.begin() + static_cast<std::ptrdiff_t>(count),
            vertices.on_border.end(), 1);
  std::vector<Side> sides(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    sides[v] = isOutside(vertices, v) ? Side::kOutside : Side::kInside;
  }
  snap(cuts, sides, vertices);
  const Cutter cutter(cuts, sides, vertices);
  std::vector<Triangle> made;
  made.reserve(triangles.size());
  for (const Triangle& t : triangles) cutter.add(t, made);
  triangles = std::move(made);
  bendBorder(field, tolerance, triangles, vertices);
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "vertices/surface_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_topology.h"

namespace pcl_slim::detail {

namespace {

/// Spacings by which trim maps make a hole narrower: each point owns half a spacing about it.
constexpr double kGrowth = 1;
constexpr double kKernelShare = 0.36;  ///< effective points of (1 - s^2)^4 over those in the ball

/** Points of the data an area [local units] at some vertices: the effective number of points of the
 * leaves there over the area of their balls that has data. 0 where there is no leaf. */
std::vector<double> densitiesAt(const ProbeField& field, const std::vector<std::uint32_t>& which,
                                const SurfaceVertices& vertices) {
  std::vector<double> densities(which.size());
  forProbeBlocks(field, which.size(), [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) {
      const ProbeScale scale =
          probe.scaleAt(vertices.position[which[i]], vertices.normal[which[i]]);
      const double ball = M_PI * scale.radius * scale.radius * scale.filled;
      densities[i] = ball > 0 ? scale.effective_count / (kKernelShare * ball) : 0;
    }
  });
  return densities;
}

/** Area of a triangle, local units. */
double areaOf(const Triangle& triangle, const SurfaceVertices& vertices) {
  const Vector3& p = vertices.position[triangle[0]];
  return 0.5 * length(cross(subtract(vertices.position[triangle[1]], p),
                            subtract(vertices.position[triangle[2]], p)));
}

/** Border loops of a mesh: vertices in the order in which a face that closes the gap has them.
 * Loops that meet a vertex twice are left out. O(T log T). */
std::vector<std::vector<std::uint32_t>> borderLoops(const std::vector<Triangle>& triangles,
                                                    std::size_t num_vertices, int threads) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> next(num_vertices, kNone);
  std::vector<bool> twice(num_vertices, false), seen(num_vertices, false);
  const EdgeTable table(triangles, threads);
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 1) continue;
    const std::uint32_t use = table.uses[edge.first];
    const std::uint32_t a = triangles[use / 3][use % 3], b = triangles[use / 3][(use % 3 + 1) % 3];
    // The triangle runs from a to b, what closes the gap from b to a.
    if (next[b] != kNone) twice[b] = true;
    next[b] = a;
  }
  std::vector<std::vector<std::uint32_t>> loops;
  for (std::uint32_t first = 0; first < num_vertices; ++first) {
    if (next[first] == kNone || seen[first]) continue;
    std::vector<std::uint32_t> loop;
    bool simple = true;
    std::uint32_t v = first;
    while (v != kNone && !seen[v]) {
      seen[v] = true;
      simple = simple && !twice[v];
      loop.push_back(v);
      v = next[v];
    }
    if (simple && v == first) loops.push_back(std::move(loop));
  }
  return loops;
}

constexpr std::size_t kMostEdges = 64;
constexpr float kBorder = 0.5f;  ///< of SurfaceVertices::outside

using Loop = std::vector<std::uint32_t>;

/** Whether there are data all around a loop. */
bool isInside(const Loop& loop, const SurfaceVertices& vertices) {
  return std::all_of(loop.begin(), loop.end(),
                     [&](std::uint32_t v) { return vertices.outside[v] <= kBorder; });
}

/** Adds the vertex in the middle of a loop, not yet on the surface. */
std::uint32_t addMiddle(const Loop& loop, SurfaceVertices& vertices) {
  const std::size_t v = vertices.count();
  vertices.resize(v + 1);
  for (const std::uint32_t i : loop) {
    vertices.position[v] =
        along(vertices.position[v], 1.0 / static_cast<double>(loop.size()), vertices.position[i]);
    vertices.normal[v] = along(vertices.normal[v], 1, vertices.normal[i]);
    vertices.size[v] = std::max(vertices.size[v], vertices.size[i]);
  }
  vertices.normal[v] = normalized(vertices.normal[v]);
  return static_cast<std::uint32_t>(v);
}

double fanArea(const Loop& loop, std::uint32_t middle, const SurfaceVertices& vertices) {
  double area = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    area += areaOf({middle, loop[i], loop[(i + 1) % loop.size()]}, vertices);
  }
  return area;
}

/** Triangles with a vertex outside, and which patch each belongs to. */
struct Patches {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> vertices;  ///< of each a vertex that is outside
  std::vector<std::uint32_t> patch;
  std::vector<float> share;  ///< of a triangle's area: corners that are outside
  std::size_t count = 0;
};

/** Patches are connected by their outer vertices alone: the inner ones are taken out of the
 * triangles. */
Patches findPatches(const std::vector<Triangle>& triangles, const SurfaceVertices& vertices) {
  Patches made;
  std::vector<Triangle> outer;
  for (const Triangle& t : triangles) {
    std::uint32_t corners[3];
    std::size_t count = 0;
    for (const std::uint32_t v : t) {
      if (vertices.outside[v] > kBorder) corners[count++] = v;
    }
    if (count == 0) continue;
    made.triangles.push_back(t);
    made.vertices.push_back(corners[0]);
    made.share.push_back(static_cast<float>(count) / 3);
    outer.push_back({corners[0], corners[count - 1], corners[count / 2]});
  }
  made.patch = componentsOf(outer, vertices.count(), made.count);
  return made;
}

}  // namespace

std::uint64_t closeGaps(const ProbeField& field, double width, std::vector<Triangle>& triangles,
                        SurfaceVertices& vertices) {
  std::vector<Loop> loops;
  std::vector<std::uint32_t> firsts, middles;
  for (Loop& loop : borderLoops(triangles, vertices.count(), field.threads)) {
    if (loop.size() > kMostEdges || !isInside(loop, vertices)) continue;
    firsts.push_back(loop[0]);
    loops.push_back(std::move(loop));
  }
  const std::vector<double> densities = densitiesAt(field, firsts, vertices);
  std::uint64_t closed = 0;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const std::uint32_t middle = addMiddle(loops[i], vertices);
    if (fanArea(loops[i], middle, vertices) * densities[i] > M_PI / 4 * width * width) continue;
    ++closed;
    if (loops[i].size() == 3) {
      triangles.push_back({loops[i][0], loops[i][1], loops[i][2]});
      continue;
    }
    middles.push_back(middle);
    for (std::size_t k = 0; k < loops[i].size(); ++k) {
      triangles.push_back({middle, loops[i][k], loops[i][(k + 1) % loops[i].size()]});
    }
  }
  putOnSurface(field, middles, vertices);
  return closed;
}

void dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
                std::vector<Triangle>& triangles, MeshStatistics& statistics) {
  std::size_t count = 0;
  const auto component = componentsOf(triangles, vertices.count(), count);
  if (count < 2 || !(min_points > 0)) return;
  std::vector<double> area(count, 0), own(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    own[t] = areaOf(triangles[t], vertices);
    area[component[t]] += own[t];
  }
  const auto largest =
      static_cast<std::uint32_t>(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<std::uint32_t> others, corners;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (component[t] == largest) continue;
    others.push_back(t);
    corners.push_back(triangles[t][0]);
  }
  const std::vector<double> densities = densitiesAt(field, corners, vertices);
  std::vector<double> points(count, 0);
  for (std::size_t i = 0; i < others.size(); ++i) {
    points[component[others[i]]] += densities[i] * own[others[i]];
  }
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (component[t] == largest || points[component[t]] >= min_points) {
      kept.push_back(triangles[t]);
    }
  }
  statistics.dropped = triangles.size() - kept.size();
  for (std::size_t c = 0; c < count; ++c) {
    if (c != largest && points[c] < min_points) ++statistics.dropped_components;
  }
  triangles = std::move(kept);
}

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

std::uint64_t closeHoles(const ProbeField& field, double hole_size,
                         const std::vector<Triangle>& triangles, SurfaceVertices& vertices) {
  if (!(hole_size > 0)) return 0;
  const Patches patches = findPatches(triangles, vertices);
  const std::vector<double> densities = densitiesAt(field, patches.vertices, vertices);
  std::vector<double> points(patches.count, 0);
  for (std::size_t i = 0; i < patches.triangles.size(); ++i) {
    points[patches.patch[i]] +=
        densities[i] * patches.share[i] * areaOf(patches.triangles[i], vertices);
  }
  std::vector<bool> open(patches.count, false), on_border(vertices.count(), false);
  for (const MeshEdge& edge : EdgeTable(triangles, field.threads).edges) {
    if (edge.count == 1) on_border[edge.low] = on_border[edge.high] = true;
  }
  for (std::size_t i = 0; i < patches.triangles.size(); ++i) {
    for (const std::uint32_t v : patches.triangles[i]) {
      if (on_border[v]) open[patches.patch[i]] = true;
    }
  }
  const double width = std::max(0.0, hole_size - kGrowth);
  const double most = M_PI / 4 * width * width;
  for (std::size_t i = 0; i < patches.triangles.size(); ++i) {
    const std::uint32_t patch = patches.patch[i];
    if (open[patch] || points[patch] >= most) continue;
    for (const std::uint32_t v : patches.triangles[i]) {
      vertices.outside[v] = std::min(vertices.outside[v], kBorder);
    }
  }
  std::uint64_t closed = 0;
  for (std::size_t patch = 0; patch < patches.count; ++patch) {
    if (!open[patch] && points[patch] < most) ++closed;
  }
  return closed;
}

namespace {

constexpr int kSteps = 4;       ///< of false position along an edge
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
        polygon[count++] = cutVertex(a, b);
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

  std::uint32_t cutVertex(std::uint32_t a, std::uint32_t b) const {
    const auto key = [](std::uint32_t p, std::uint32_t q) {
      return static_cast<std::uint64_t>(std::min(p, q)) << 32 | std::max(p, q);
    };
    const auto at = std::lower_bound(
        cuts_.begin(), cuts_.end(), key(a, b),
        [&](const Cut& cut, std::uint64_t k) { return key(cut.inner, cut.outer) < k; });
    return at->vertex;
  }

  const std::vector<Cut>& cuts_;
  const std::vector<Side>& sides_;
  const SurfaceVertices& vertices_;
};

}  // namespace

void trimAtBorder(const ProbeField& field, std::vector<Triangle>& triangles,
                  SurfaceVertices& vertices) {
  const std::size_t count = vertices.count();
  std::vector<Cut> cuts = cutsOf(EdgeTable(triangles, field.threads), vertices);
  vertices.resize(count + cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    cuts[i].vertex = static_cast<std::uint32_t>(count + i);
  }
  findBorder(field, count, cuts, vertices);
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
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "trim/mending.h"

#include <algorithm>
#include <cmath>

#include "topology/fans.h"

namespace pcl_slim::detail {

namespace {

constexpr double kKernelShare = 0.36;  ///< effective points of (1 - s^2)^4 over those in the ball

/** Points of the data an area [local units] at some vertices: the effective number of points of the leaves
 * there over the area of their balls. 0 where there is no leaf. */
std::vector<double>
densitiesAt(const ProbeField& field, const std::vector<std::uint32_t>& which,
            const SurfaceVertices& vertices)
{
  std::vector<double> densities(which.size());
  forProbeBlocks(field, which.size(), [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) {
      const ProbeScale scale =
          probe.scaleAt(vertices.position[which[i]], vertices.normal[which[i]]);
      const double ball = M_PI * scale.radius * scale.radius;
      densities[i] = ball > 0 ? scale.effective_count / (kKernelShare * ball) : 0;
    }
  });
  return densities;
}

/** Area of a triangle, local units. */
double
areaOf(const Triangle& triangle, const SurfaceVertices& vertices)
{
  const Vector3& p = vertices.position[triangle[0]];
  return 0.5 * length(cross(subtract(vertices.position[triangle[1]], p),
                            subtract(vertices.position[triangle[2]], p)));
}

/** Border loops of a mesh: vertices in the order in which a face that closes the gap has them. Loops that meet
 * a vertex twice are left out. O(T log T). */
std::vector<std::vector<std::uint32_t>>
borderLoops(const std::vector<Triangle>& triangles, std::size_t num_vertices, int threads)
{
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
constexpr float kBorder = 0.5f;

using Loop = std::vector<std::uint32_t>;

/** Whether there are data all around a loop. */
bool
isInside(const Loop& loop, const SurfaceVertices& vertices)
{
  return std::all_of(loop.begin(), loop.end(),
                     [&](std::uint32_t v) { return vertices.outside[v] <= kBorder; });
}

/** Adds the vertex in the middle of a loop, not yet on the surface. */
std::uint32_t
addMiddle(const Loop& loop, SurfaceVertices& vertices)
{
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

double
fanArea(const Loop& loop, std::uint32_t middle, const SurfaceVertices& vertices)
{
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

/** Patches are connected by their outer vertices alone: the inner ones are taken out of the triangles. */
Patches
findPatches(const std::vector<Triangle>& triangles, const SurfaceVertices& vertices)
{
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

std::uint64_t
closeGaps(const ProbeField& field, double width, std::vector<Triangle>& triangles,
          SurfaceVertices& vertices)
{
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

void
dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
           std::vector<Triangle>& triangles, MeshStatistics& statistics)
{
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

void
markUncovered(const ProbeField& field, double threshold, SurfaceVertices& vertices)
{
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

std::uint64_t
closeHoles(const ProbeField& field, double hole_size, const std::vector<Triangle>& triangles,
           SurfaceVertices& vertices)
{
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
  const double most = M_PI / 4 * hole_size * hole_size;
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

}  // namespace pcl_slim::detail

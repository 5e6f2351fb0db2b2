// SPDX-License-Identifier: BSD-3-Clause
#include "trim/holes.h"

#include <cmath>

#include "topology/fans.h"
#include "trim/point_density.h"

namespace pcl_slim::detail {

namespace {

constexpr float kBorder = 0.5f;

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

// SPDX-License-Identifier: BSD-3-Clause
#include "trim/close_gaps.h"

#include <algorithm>
#include <cmath>

#include "topology/gaps.h"
#include "trim/point_density.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kMostEdges = 64;
constexpr float kBorder = 0.5f;

using Loop = std::vector<std::uint32_t>;

/** Whether data lie all around a loop. */
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

}  // namespace pcl_slim::detail

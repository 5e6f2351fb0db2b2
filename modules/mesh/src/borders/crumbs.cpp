// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>

#include "borders/borders.h"

namespace pcl_slim::detail {

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

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing/normal_filter.h"

#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

std::vector<Vector3>
filterNormals(const NormalFilter& filter, const std::vector<Vector3>& guide,
              const std::vector<Vector3>& normals)
{
  std::vector<Vector3> made(normals.size());
  const double factor = -0.5 / (filter.range * filter.range);
  parallelFor(normals.size(), resolveThreads(filter.threads), 256, [&](std::size_t f, int) {
    Vector3 sum = scaled(normals[f], filter.geometry.areas[f]);
    for (const std::uint32_t g : filter.topology.around(f)) {
      const Vector3 step = subtract(guide[g], guide[f]);
      sum = along(sum, filter.geometry.areas[g] * std::exp(factor * dot(step, step)), normals[g]);
    }
    const double size = length(sum);
    made[f] = size > 0 ? scaled(sum, 1 / size) : normals[f];
  });
  return made;
}

std::vector<Vector3>
ringNormals(const NormalFilter& filter, const std::vector<Vector3>& normals)
{
  std::vector<Vector3> made(normals.size());
  parallelFor(normals.size(), resolveThreads(filter.threads), 256, [&](std::size_t f, int) {
    Vector3 sum{};
    for (const std::uint32_t g : filter.topology.around(f)) {
      sum = along(sum, filter.geometry.areas[g], normals[g]);
    }
    made[f] = normalized(sum);
  });
  return made;
}

void
mendLoneNormals(const NormalFilter& filter, std::vector<Vector3>& normals)
{
  const std::vector<Vector3> ring = ringNormals(filter, normals);
  constexpr double kLeast = 0.4;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    if (ring[f] != Vector3{} && dot(ring[f], normals[f]) < kLeast) normals[f] = ring[f];
  }
}

void
pullNormals(const std::vector<Vector3>& others, double weight, std::vector<Vector3>& normals)
{
  for (std::size_t f = 0; f < normals.size(); ++f) {
    normals[f] = normalized(along(normals[f], weight, others[f]));
  }
}

}  // namespace pcl_slim::detail

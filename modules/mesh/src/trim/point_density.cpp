// SPDX-License-Identifier: BSD-3-Clause
#include "trim/point_density.h"

#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kKernelShare = 0.36;  ///< effective points of (1 - s^2)^4 over those in the ball

}  // namespace

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

double
areaOf(const Triangle& triangle, const SurfaceVertices& vertices)
{
  const Vector3& p = vertices.position[triangle[0]];
  return 0.5 * length(cross(subtract(vertices.position[triangle[1]], p),
                            subtract(vertices.position[triangle[2]], p)));
}

}  // namespace pcl_slim::detail

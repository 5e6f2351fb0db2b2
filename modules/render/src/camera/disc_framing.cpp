// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/disc_framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace pcl_slim {
namespace {

constexpr float kLeastRadius = 1e-3f;  ///< of the extent: a cloud that is one point is seen as well

}  // namespace

SLIMSurface
framingOf(const SplatSet& splats)
{
  SLIMSurface surface;
  surface.info.degree = 1;
  surface.info.oriented = true;
  surface.info.cover_radius = 1.0;
  surface.info.num_points = splats.size();
  surface.info.origin = splats.origin;
  surface.resize(splats.size());
  if (splats.empty()) return surface;

  const std::vector<float>* const from[3] = {&splats.x, &splats.y, &splats.z};
  std::vector<float>* const to[3] = {&surface.cx, &surface.cy, &surface.cz};
  std::array<double, 3> middle{};
  double diagonal_sq = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax_element(from[a]->begin(), from[a]->end());
    middle[a] = 0.5 * (double{*low} + *high);
    surface.info.origin[a] += middle[a];
    diagonal_sq += (double{*high} - *low) * (double{*high} - *low);
  }
  const double widest = *std::max_element(splats.radius.begin(), splats.radius.end());
  const double extent = std::max(std::sqrt(diagonal_sq), widest);
  const double scale = extent > 0.0 ? extent : 1.0;
  surface.info.scale = scale;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      (*to[a])[i] = static_cast<float>(((*from[a])[i] - middle[a]) / scale);
    }
    surface.nx[i] = splats.nx[i];
    surface.ny[i] = splats.ny[i];
    surface.nz[i] = splats.nz[i];
    surface.radius[i] = std::max(kLeastRadius, static_cast<float>(splats.radius[i] / scale));
    surface.degree[i] = 1;
    surface.level[i] = 1;
    surface.flags[i] = kSurfelLeaf;
  }
  return surface;
}

}  // namespace pcl_slim

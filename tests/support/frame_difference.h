// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::test {

inline double percentile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/** \brief How far two G-buffers differ. */
struct FrameDifference {
  std::size_t both = 0, one = 0;          ///< pixels that both cover, that one does
  double normal_p95 = 0, normal_p99 = 0;  ///< degrees
  double depth_p99 = 0;                   ///< of the surface's diagonal
  double curvature_p95 = 0;               ///< of the curvature's own 95th percentile
  std::size_t leaves = 0;                 ///< pixels whose leaf has another level or radius
};

inline FrameDifference compareFrames(const GBuffer& seen, const GBuffer& truth, double diagonal) {
  FrameDifference d;
  std::vector<double> normals, depths, curvatures, sizes;
  for (std::size_t i = 0; i < truth.numPixels(); ++i) {
    if (seen.covered(i) != truth.covered(i)) ++d.one;
    if (!seen.covered(i) || !truth.covered(i)) continue;
    ++d.both;
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double step = double{seen.normal[i][k]} - truth.normal[i][k];
      square += step * step;
    }
    normals.push_back(2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(square))) * 180.0 / M_PI);
    depths.push_back(std::abs(double{seen.depth[i]} - truth.depth[i]) / diagonal);
    for (std::size_t k = 0; k < 2; ++k) {
      curvatures.push_back(std::abs(double{seen.principal[i][k]} - truth.principal[i][k]));
      sizes.push_back(std::abs(double{truth.principal[i][k]}));
    }
    const bool same_radius = std::abs(seen.radius[i] / truth.radius[i] - 1.0f) < 0.05f;
    d.leaves += seen.level[i] != truth.level[i] || !same_radius;
  }
  d.normal_p95 = percentile(normals, 0.95);
  d.normal_p99 = percentile(normals, 0.99);
  d.depth_p99 = percentile(depths, 0.99);
  d.curvature_p95 = percentile(curvatures, 0.95) / std::max(1e-30, percentile(sizes, 0.95));
  return d;
}

}  // namespace pcl_slim::test

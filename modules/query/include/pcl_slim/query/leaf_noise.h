// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Mean distance of the points behind a leaf, local units: with weights (1 - s^2)^4 their
 * effective number is .36 of those in the ball. */
inline double leafSpacing(const SLIMSurface& surface, std::size_t leaf) {
  const double points = std::max(1.0, surface.effective_count[leaf] / 0.36);
  return surface.radius[leaf] * std::sqrt(M_PI / points);
}

/** \brief Variance of the errors of a leaf's points [squared local length]: that of its residual, and
 * what its coefficients follow of errors of the surface's variance lambda. Detail that the leaf does
 * not show is in it, too. */
inline double leafNoise(const SLIMSurface& surface, std::size_t leaf) {
  const SurfaceInfo& info = surface.info;
  const double count = std::max(1.0, double{surface.effective_count[leaf]});
  const double shared = std::clamp(info.correlation, 1.0, count);
  const double followed = std::min(1.0, shared * numCoefficients(surface.degree[leaf]) / count);
  const double residual = surface.error[leaf];
  return residual * residual +
         std::max(0.0, info.lambda) * info.diagonal * info.diagonal * followed;
}

/** \brief Number of points with errors of the surface's variance lambda that determine a leaf as well
 * as its own points do. It exceeds their effective number where noise varies over a scan and is low
 * there. */
inline double equivalentCount(const SLIMSurface& surface, std::size_t leaf) {
  const SurfaceInfo& info = surface.info;
  const double count = std::max(1.0, double{surface.effective_count[leaf]});
  const double lambda = std::max(0.0, info.lambda) * info.diagonal * info.diagonal;
  const double own = leafNoise(surface, leaf);
  return own > 0 ? count * std::max(1.0, lambda / own) : count;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A surface as a page has it: no links, but the sizes that a level of detail uses. */
struct WebSurface {
  SLIMSurface surface;  ///< leaves first, then internal surfels, each along a Morton curve
  std::vector<float> own, parent;  ///< detail::DetailSizes
};

/** \brief Packs a surface for a page: quantised columns, deflated with a checksum (gzip).
 *
 * Centres take 16 bits an axis, normals 12 bits a coordinate, radii and detail sizes 8-bit logarithms,
 * residuals 12-bit ones, colours their 18 bytes. Coefficients are rewritten for the rounded ball and frame before they are rounded, so
 * that the surface moves by their steps alone. effective_count is left out.
 * \param[in] precision steps of a coefficient per radius, 16 ... 65536, and four times as many of the
 * constant one; 0: nothing is rounded. 640 moves normals by .05 degrees (95th percentile).
 * O(surfels + links). The bytes are the same for every run. */
PCL_SLIM_EXPORT Result<std::vector<unsigned char>>
encodeWebSurface(const SLIMSurface& surface, double precision = 896.0);

/** \brief Inverse of encodeWebSurface, as the viewer does it. Truncated, damaged or foreign bytes give
 * an error. */
PCL_SLIM_EXPORT Result<WebSurface>
decodeWebSurface(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim

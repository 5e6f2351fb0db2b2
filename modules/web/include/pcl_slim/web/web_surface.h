// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Packs a surface for a page: quantised columns, deflated with a checksum (gzip).
 *
 * Centres take 16 bits an axis, normals 12 bits a coordinate, radii and detail sizes 8-bit
 * logarithms, residuals 12-bit ones, colours their 18 bytes. Coefficients are rewritten for the
 * rounded ball and frame before they are rounded, so that the surface moves by their steps alone.
 * Texels that colour a place of a surfel's disc are predicted from those before them; radii of
 * surfaces with textures take 12 bits. effective_count is left out.
 * \param[in] precision steps of a coefficient per radius, 16 ... 65536, and four times as many of
 * the constant one; 0: nothing is rounded. 640 moves normals by .05 degrees (95th percentile).
 * \param[in] color_error [1/255] greatest change of a channel of a texel, 0 ... 32; 0: none changes.
 * O(surfels + links + texels). The bytes are the same for every run. */
PCL_SLIM_EXPORT Result<std::vector<unsigned char>> encodeWebSurface(const SLIMSurface& surface,
                                                                    double precision = 896.0,
                                                                    int color_error = 2);

}  // namespace pcl_slim

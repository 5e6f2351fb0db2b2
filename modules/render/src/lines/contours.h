// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lines/pixel_geometry.h"
#include "pcl_slim/render/picture_lines.h"

namespace pcl_slim::detail {

/** \brief Lines between pixels where the surface ends or hides what is behind it: the nearer
 * pixel's tangent plane passes the farther one by more than six pixels and .3 % of L. The pixels'
 * edges are smoothed; lines shorter than the least length are left out. */
void
traceContours(const PixelGeometry& geometry, double least_length, int threads,
              std::vector<PictureLine>& lines);

}  // namespace pcl_slim::detail

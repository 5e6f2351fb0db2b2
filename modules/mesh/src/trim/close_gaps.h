// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Closes gaps that contouring has left where the surface goes on: border loops of few edges, on whose area fewer
 * points would lie than on a disc `width` spacings wide, with data on all sides. A gap of three edges gets a
 * triangle, others a fan about a vertex on the surface. \return how many. O(T log T). */
std::uint64_t
closeGaps(const ProbeField& field, double width, std::vector<Triangle>& triangles,
          SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

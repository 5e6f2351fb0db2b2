// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Cuts triangles where the surface's data end: along the line on which SurfaceVertices::outside is 1/2.
 * Vertices next to that line are brought onto it, others are on edges that it crosses; vertices are
 * added, none is taken away. O(T), and a few evaluations for each edge that the line crosses. */
void
trimAtBorder(const ProbeField& field, std::vector<Triangle>& triangles, SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Collapses edges of a manifold mesh until it has a given number of triangles or fewer, those of least quadric error first
 * (Garland, Heckbert: Surface simplification using quadric error metrics, SIGGRAPH 1997). What would change the
 * topology, or turn a triangle over, is not collapsed; borders stay where they are. Vertices that no triangle
 * names are left over. O(T log T), in one thread. */
void
collapseEdges(std::size_t most_triangles, std::vector<Triangle>& triangles,
              SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

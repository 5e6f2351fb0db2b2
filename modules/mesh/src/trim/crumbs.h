// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Leaves out components on which fewer points lie than asked for; the largest always stays. O(T). */
void
dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
           std::vector<Triangle>& triangles, MeshStatistics& statistics);

}  // namespace pcl_slim::detail

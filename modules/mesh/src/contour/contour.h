// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "contour/probe_blocks.h"
#include "contour/sheet_vertices.h"
#include "octree/cell_tree.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/mesh/mesh_extraction.h"

namespace pcl_slim::detail {

/** Contours the surface on a tree: edges, distances at corners, crossings, vertices. Cells with vertices on
 * an edge of more than two faces are divided and their edges contoured again, a few times at most. */
SheetVertices
contour(const ProbeField& field, bool oriented, CellTree& tree, MeshStatistics& statistics,
        const Progress* progress);

}  // namespace pcl_slim::detail

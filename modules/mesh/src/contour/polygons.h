// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contour/sheet_vertices.h"
#include "topology/fans.h"

namespace pcl_slim::detail {

/** The cells of vertices on edges that more than two faces share, ascending. O(faces log faces). */
std::vector<std::uint32_t>
crowdedCells(const SheetVertices& vertices, int threads);

/** The faces around crossings as triangles. Quadrilaterals are cut along the diagonal whose triangles face
 * their vertices' normals best; along the shorter one where both do well. O(faces). */
std::vector<Triangle>
cutIntoTriangles(const std::vector<std::array<std::uint32_t, 4>>& faces,
                 const std::vector<Vector3>& positions, const std::vector<Vector3>& normals);

}  // namespace pcl_slim::detail

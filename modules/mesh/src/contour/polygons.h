// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contour/crossings.h"
#include "topology/fans.h"

namespace pcl_slim::detail {

/** One vertex for each sheet of surface in a cell, before it is put onto the surface. */
struct SheetVertices {
  std::vector<std::array<std::uint32_t, 4>> of_crossing;  ///< in the cells around each crossing
  std::vector<std::uint32_t> cell;                        ///< of each vertex, ascending
  std::vector<Vector3> position;                          ///< mean of its crossings
  std::vector<Vector3> normal;                            ///< mean, unit
  std::vector<float> size;                                ///< least edge that it crosses
};

/** Crossings on the border of the face between two cells are linked in pairs, by curves of the surface in
 * that face; crossings linked in a cell are of one sheet there. So each edge of the mesh, a curve in a face,
 * borders two faces of the mesh, its crossings, unless a sheet ends there. O(crossings). */
SheetVertices
findSheetVertices(const std::vector<EdgeCrossing>& crossings, bool oriented, int threads);

/** The cells of vertices on edges that more than two faces share, ascending. O(faces log faces). */
std::vector<std::uint32_t>
crowdedCells(const SheetVertices& vertices, int threads);

/** The faces around crossings as triangles. Quadrilaterals are cut along the diagonal whose triangles face
 * their vertices' normals best; along the shorter one where both do well. O(faces). */
std::vector<Triangle>
cutIntoTriangles(const std::vector<std::array<std::uint32_t, 4>>& faces,
                 const std::vector<Vector3>& positions, const std::vector<Vector3>& normals);

}  // namespace pcl_slim::detail

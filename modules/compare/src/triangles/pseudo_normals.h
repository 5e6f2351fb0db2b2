// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/compare/triangle_index.h"
#include "pcl_slim/core/vector3.h"
#include "triangles/closest_point.h"
#include "triangles/welding.h"

namespace pcl_slim::detail {

/** \brief Normals of the faces, edges and vertices of welded triangles, and the border. */
struct PseudoNormals {
  std::vector<std::array<float, 3>> face;  ///< unit; of flat triangles that of a neighbour, or zero
  std::vector<std::array<std::uint32_t, 3>> edge_of;  ///< of each triangle, from corner k on
  std::vector<std::array<float, 3>> edge, vertex;     ///< unit, or zero
  std::vector<std::uint8_t> edge_border, vertex_border;
};

/** \brief Angle-weighted normals (Baerentzen and Aanaes 2005). A flat triangle connects the edges
 * that it has: they count as one, which has the normals of all triangles at it. \param[in] places of
 * the welded vertices, finite \param[out] statistics counts of edges. O(T log T). */
PseudoNormals pseudoNormals(const WeldedTriangles& welded, const std::vector<Vector3>& places,
                            const std::vector<TriangleShape>& shapes, int threads,
                            TriangleIndexStatistics& statistics);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/mesh/mesh_faces.h"

namespace pcl_slim::detail {

/** \brief Counts edges along which two faces run in the same direction, so that their sides
 * disagree, and edges of more than two faces. O(corners log corners). */
void countEdges(const MeshFaces& faces, std::uint64_t& disagreeing, std::uint64_t& nonmanifold);

/** The vertices of a triangle, counter-clockwise. */
using Triangle = std::array<std::uint32_t, 3>;

/** An edge of a mesh with the triangles it is part of. */
struct MeshEdge {
  std::uint32_t low, high;  ///< vertices
  std::uint32_t first;      ///< of its uses, in EdgeTable::uses
  std::uint32_t count;      ///< triangles
};

/** All edges of some triangles. */
struct EdgeTable {
  std::vector<MeshEdge> edges;      ///< ascending by low, then high
  std::vector<std::uint32_t> uses;  ///< 3 t + k: triangle t from its corner k to the next

  PCL_SLIM_EXPORT EdgeTable(const std::vector<Triangle>& triangles, int threads);
};

/** Gives each fan of triangles about a vertex a vertex of its own; fans are connected across edges
 * of two triangles. No edge has more than two triangles afterwards, unless these are one fan at
 * either end.
 * \return of each vertex made the one it is a copy of. O(T log T). */
std::vector<std::uint32_t> separateFans(std::size_t num_vertices, std::vector<Triangle>& triangles,
                                        int threads);

/** Turns small regions of triangles until neighbours agree; large ones keep their sides
 * (signsByVotes()). \return of each triangle whether it was turned. O(T log T). */
std::vector<std::uint8_t> agreeOnSides(std::vector<Triangle>& triangles, int threads);

/** Takes away triangles until none runs along an edge in the direction of another. Only what cannot
 * be one side of a body loses any. O(T log T). */
void dropTurned(std::vector<Triangle>& triangles, int threads);

/** Takes away the triangles that are not alive. */
void keepAlive(const std::vector<bool>& alive, std::vector<Triangle>& triangles);

/** The number of each triangle's component, connected by vertices; components are numbered by their
 * first triangle. \param[out] count how many. */
PCL_SLIM_EXPORT std::vector<std::uint32_t> componentsOf(const std::vector<Triangle>& triangles,
                                                        std::size_t num_vertices,
                                                        std::size_t& count);

}  // namespace pcl_slim::detail

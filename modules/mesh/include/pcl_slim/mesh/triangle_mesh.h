// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

/** \brief Triangles over shared vertices; corners go round counter-clockwise as seen from outside.
 */
struct PCL_SLIM_EXPORT TriangleMesh {
  std::vector<Vector3> vertices;              ///< world coordinates
  std::vector<std::array<float, 3>> normals;  ///< unit, one a vertex
  std::vector<float> k1, k2;                  ///< principal curvatures, k1 >= k2, 1/length
  std::vector<float> sigma;  ///< standard error of a vertex along its normal, or empty
  std::vector<std::array<std::uint8_t, 3>> colors;      ///< red green blue a vertex, or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertices of each

  void clear() { *this = TriangleMesh(); }

  /** \brief Names a column of another length than vertices, or a triangle with a corner that is no
   * vertex. O(triangles). */
  Error validate() const;
};

/** \brief What kind of surface the triangles of a mesh make. */
struct MeshCensus {
  std::uint64_t vertices = 0, triangles = 0, edges = 0;
  std::uint64_t components = 0;            ///< sets of triangles connected by vertices
  std::uint64_t border_edges = 0;          ///< edges of one triangle
  std::uint64_t nonmanifold_edges = 0;     ///< edges of more than two triangles
  std::uint64_t nonmanifold_vertices = 0;  ///< whose triangles make more than one fan
  std::uint64_t turned_edges = 0;          ///< run in the same direction by both of their triangles
  std::int64_t euler = 0;                  ///< vertices - edges + triangles
};

/** \brief Counts a mesh's edges, components and defects. Vertices without a triangle do not count;
 * indices must be valid. O(T log T) for T triangles. */
PCL_SLIM_EXPORT MeshCensus censusOf(const TriangleMesh& mesh);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

/** \brief A view of a row of numbers. */
struct IndexRow {
  const std::uint32_t *first = nullptr, *last = nullptr;

  const std::uint32_t* begin() const { return first; }
  const std::uint32_t* end() const { return last; }
  std::size_t size() const { return static_cast<std::size_t>(last - first); }
  std::uint32_t operator[](std::size_t i) const { return first[i]; }
};

/** \brief Faces of a mesh as lists of vertices: triangles, quadrilaterals or larger, in any
 * mixture.
 *
 * Corners go round the face counter-clockwise as seen from outside. Faces of fewer than three
 * corners are allowed and ignored.
 */
struct PCL_SLIM_EXPORT MeshFaces {
  std::vector<std::uint32_t> begin;    ///< size() + 1 offsets into corners, or empty
  std::vector<std::uint32_t> corners;  ///< vertices, face after face

  std::size_t size() const { return begin.empty() ? 0 : begin.size() - 1; }
  IndexRow operator[](std::size_t f) const {
    return {corners.data() + begin[f], corners.data() + begin[f + 1]};
  }
  /** \brief Adds a face of these corners. */
  void add(const std::uint32_t* first, std::size_t count);

  /** \brief Offsets that do not ascend, or a corner that is no vertex. O(corners). */
  Error validate(std::size_t num_vertices) const;
};

/** \brief Area vector of a face: along its normal, as long as its area. Not finite where a corner
 * is not; zero for fewer than three corners. */
PCL_SLIM_EXPORT Vector3 areaVector(const std::vector<Vector3>& vertices, IndexRow corners);

/** \brief Mean of a face's corners. */
PCL_SLIM_EXPORT Vector3 centroid(const std::vector<Vector3>& vertices, IndexRow corners);

/** \brief Adjacency of the faces of a mesh. */
class PCL_SLIM_EXPORT MeshTopology {
 public:
  /** \brief faces must be valid for this number of vertices. O(corners log faces around a vertex).
   */
  MeshTopology(const MeshFaces& faces, std::size_t num_vertices);

  /** \brief Faces that have vertex v as a corner, ascending. */
  IndexRow facesOf(std::size_t v) const { return row(vertex_begin_, vertex_faces_, v); }
  /** \brief Faces that share an edge with face f, ascending: all of them where more than two meet.
   */
  IndexRow acrossEdges(std::size_t f) const { return row(edge_begin_, edge_faces_, f); }
  /** \brief Faces that share a corner with face f, ascending. */
  IndexRow around(std::size_t f) const { return row(around_begin_, around_faces_, f); }

 private:
  static IndexRow row(const std::vector<std::uint32_t>& begin,
                      const std::vector<std::uint32_t>& values, std::size_t i) {
    return {values.data() + begin[i], values.data() + begin[i + 1]};
  }
  void findFacesOfVertices(const MeshFaces& faces, std::size_t num_vertices);
  void findNeighbours(const MeshFaces& faces);

  std::vector<std::uint32_t> vertex_begin_, vertex_faces_, edge_begin_, edge_faces_, around_begin_,
      around_faces_;
};

}  // namespace pcl_slim

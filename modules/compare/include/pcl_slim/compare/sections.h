// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief The plane of places x with normal . x = offset, with axes for drawing in it. */
struct PCL_SLIM_EXPORT SectionPlane {
  Vector3 normal{0, 0, 1};  ///< unit
  double offset = 0;
  Vector3 right{1, 0, 0}, up{0, 1, 0};  ///< unit; right x up = normal

  /** \brief The plane through a place. Up is the z axis as seen in the plane, or the y axis where
   * the plane is level. \return an error for a normal that is zero or not finite. */
  static Result<SectionPlane> through(const Vector3& place, const Vector3& normal);

  /** \brief Coordinates of a place along right and up. */
  std::array<double, 2> flat(const Vector3& p) const { return {dot(p, right), dot(p, up)}; }
};

/** \brief A line in which a plane cuts a mesh, along the edges of its triangles. */
struct SectionLine {
  bool closed = false;          ///< the last point connects to the first, which is not repeated
  std::vector<Vector3> points;  ///< world coordinates
  /// the edge of the mesh that each point is on: point = (1 - share) low + share high
  std::vector<std::array<std::uint32_t, 2>> edge;  ///< vertices low and high
  std::vector<double> share;
};

/** \brief Cuts a mesh by a plane. Lines run with the outside of the mesh to their right as seen from
 * the tip of the plane's normal, where triangles are turned consistently: outlines go round
 * counter-clockwise.
 *
 * A vertex in the plane counts as above it, so that each triangle is cut in one segment or none and
 * lines of a closed mesh are closed. Segments are linked by the edges that they share; corners of
 * equal coordinates count as one vertex. Lines begin at their least edge, those that are not closed
 * at an end, and are sorted by it. At edges of more than two triangles lines end. Triangles that are
 * not finite are left out. \return an error for an invalid mesh. O(T + S log S) for S segments. */
PCL_SLIM_EXPORT Result<std::vector<SectionLine>> cutMesh(const TriangleMesh& mesh,
                                                         const SectionPlane& plane);

}  // namespace pcl_slim

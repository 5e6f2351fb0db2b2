// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "smoothing/face_geometry.h"

namespace pcl_slim::detail {

/** \brief A mesh whose vertices are to move. */
struct MovingMesh {
  const MeshFaces& faces;
  const MeshTopology& topology;
  std::vector<Vector3>& vertices;
  std::vector<std::uint8_t>& held;  ///< set for vertices not moved, lest a face turn over
  int threads = 0;
};

/** \brief Moves vertices until faces have the normals given: steps down the sum over faces and their
 * corners v of (n . (v - c))^2, c being the face's centroid (Sun, Rosin, Martin, Langbein 2007).
 *
 * Positions carry no anchor: mean positions stay as they are, and the normals determine how noise is removed.
 */
void
followNormals(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh);

/** \brief Brings the corners of faces that face away from the normals given nearer to the middle of
 * their neighbours, along the surface, step by step until none does or steps are used up. */
void
unfold(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh);

/** \brief Moves each vertex to where the weighted sum of squared distances from the planes of its
 * faces is least (Garland, Heckbert 1997); directions the planes leave open keep the vertex near its
 * place, by a term of regularity times the distance squared. */
void
minimiseQuadrics(const std::vector<Vector3>& places, const std::vector<Vector3>& normals,
                 const std::vector<double>& areas, double regularity, const MovingMesh& mesh);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_faces.h"

namespace pcl_slim::detail {

/** \brief Places, sizes and normals of a mesh's faces. */
struct FaceGeometry {
  std::vector<Vector3> centroids;
  std::vector<Vector3> normals;  ///< unit; zero without area
  std::vector<double> areas;
};

FaceGeometry measureFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces,
                          int threads);

/** \brief Sums of face normals around each vertex, weighed by area and made unit. */
std::vector<Vector3> vertexNormals(const FaceGeometry& geometry,
                                   const std::vector<Vector3>& face_normals,
                                   const MeshTopology& topology, std::size_t num_vertices,
                                   int threads);

/** \brief Mean length of the faces' edges; 0 without faces. */
double meanEdgeLength(const std::vector<Vector3>& vertices, const MeshFaces& faces);

/** \brief Share of the angles between neighbouring faces, summed, that is in those above 30
 * degrees. A part with flat and gently bent faces has most of its bending there, a body little. */
double sharpShare(const std::vector<Vector3>& normals, const MeshTopology& topology);

/** \brief The input of a pass over face normals in addition to the normals. */
struct NormalFilter {
  const FaceGeometry& geometry;
  const MeshTopology& topology;
  double range = 0.5;  ///< deviation over differences of guiding normals
  int threads = 0;
};

/** \brief Means of the normals of each face and those around it, weighed by area and by how much
 * their guiding normals agree with the face's. A face that finds no other keeps its normal. */
std::vector<Vector3> filterNormals(const NormalFilter& filter, const std::vector<Vector3>& guide,
                                   const std::vector<Vector3>& normals);

/** \brief Means of the normals of the faces around each face, weighed by area; zero without any. */
std::vector<Vector3> ringNormals(const NormalFilter& filter, const std::vector<Vector3>& normals);

/** \brief Replaces normals that differ from all around them by the mean of those. No edge separates
 * one face from all its neighbours by that much (66 degrees from their mean); folds and slivers do.
 */
void mendLoneNormals(const NormalFilter& filter, std::vector<Vector3>& normals);

/** \brief Unit vectors along normals + weight * others, where others are not zero. */
void pullNormals(const std::vector<Vector3>& others, double weight, std::vector<Vector3>& normals);

/** \brief A mesh whose vertices are to move. */
struct MovingMesh {
  const MeshFaces& faces;
  const MeshTopology& topology;
  std::vector<Vector3>& vertices;
  std::vector<std::uint8_t>& held;  ///< set for vertices not moved, lest a face turn over
  int threads = 0;
};

/** \brief Moves vertices until faces have the normals given: steps down the sum over faces and
 * their corners v of (n . (v - c))^2, c being the face's centroid (Sun, Rosin, Martin, Langbein
 * 2007).
 *
 * Positions carry no anchor: mean positions stay as they are, and the normals determine how noise
 * is removed.
 */
void followNormals(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh);

/** \brief Brings the corners of faces that face away from the normals given nearer to the middle of
 * their neighbours, along the surface, step by step until none does or steps are used up. */
void unfold(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh);

/** \brief Moves each vertex to where the weighted sum of squared distances from the planes of its
 * faces is least (Garland, Heckbert 1997); directions the planes leave open keep the vertex near
 * its place, by a term of regularity times the distance squared. */
void minimiseQuadrics(const std::vector<Vector3>& places, const std::vector<Vector3>& normals,
                      const std::vector<double>& areas, double regularity, const MovingMesh& mesh);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

FaceGeometry
measureFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces, int threads);

/** \brief Sums of face normals around each vertex, weighed by area and made unit. */
std::vector<Vector3>
vertexNormals(const FaceGeometry& geometry, const std::vector<Vector3>& face_normals,
              const MeshTopology& topology, std::size_t num_vertices, int threads);

/** \brief Mean length of the faces' edges; 0 without faces. */
double
meanEdgeLength(const std::vector<Vector3>& vertices, const MeshFaces& faces);

/** \brief Share of the angles between neighbouring faces, summed, that is in those above 30 degrees.
 * A part with flat and gently bent faces has most of its bending there, a body little. */
double
sharpShare(const std::vector<Vector3>& normals, const MeshTopology& topology);

}  // namespace pcl_slim::detail

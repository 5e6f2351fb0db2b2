// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_faces.h"

namespace pcl_slim::mesh_bench {

using Points = std::vector<Vector3>;

/** \brief A noisy mesh and its original: vertex i of one is vertex i of the other. */
struct Pair {
  std::string name;
  MeshFaces faces;
  Points noisy, truth;
  double edge = 0;  ///< mean edge length of the original
};

/** \brief Reads FOLDER/NAME_noisy.ply and FOLDER/NAME_original.ply. */
Result<Pair> loadPair(const std::string& folder, const std::string& name);

/** \brief A mesh alone. */
struct Mesh {
  Points vertices;
  MeshFaces faces;
};

/** \brief Reads a .ply with faces. */
Result<Mesh> loadMesh(const std::string& path);

/** \brief Writes a mesh as .ply. */
Error saveMesh(const std::string& path, const Points& vertices, const MeshFaces& faces);

/** \brief Unit normals of all faces, zero for those without area. */
Points faceNormals(const Points& vertices, const MeshFaces& faces);

/** \brief Means of the faces' corners. */
Points faceCentroids(const Points& vertices, const MeshFaces& faces);

/** \brief Areas of all faces. */
std::vector<double> faceAreas(const Points& vertices, const MeshFaces& faces);

/** \brief Mean distance of the centroids of faces that share an edge. */
double meanCentroidDistance(const Points& centroids, const MeshTopology& topology);

/** \brief Mean edge length, each edge counted once a face. */
double meanEdge(const Points& vertices, const MeshFaces& faces);

}  // namespace pcl_slim::mesh_bench

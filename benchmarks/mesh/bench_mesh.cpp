// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/bench_mesh.h"

#include <cstring>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim::mesh_bench {

namespace {

Points positionsOf(const PointFile& file) {
  Points points(numPoints(file.cloud));
  for (std::size_t a = 0; a < 3; ++a) {
    const int field = findField(file.cloud, std::string(1, static_cast<char>('x' + a)));
    for (std::size_t i = 0; i < points.size() && field >= 0; ++i) {
      points[i][a] = fieldValue(file.cloud, i, file.cloud.fields[static_cast<std::size_t>(field)]);
    }
  }
  return points;
}

}  // namespace

Result<Mesh> loadMesh(const std::string& path) {
  const auto file = loadPointFile(path);
  if (!file) return file.error();
  Mesh mesh;
  mesh.vertices = positionsOf(*file);
  mesh.faces.begin = file->face_begin;
  mesh.faces.corners = file->face_vertices;
  if (mesh.faces.size() > 0) return mesh;
  return Error{ErrorCode::kBadInput, "'" + path + "' has no faces; name a mesh"};
}

Result<Pair> loadPair(const std::string& folder, const std::string& name) {
  auto noisy = loadMesh(folder + "/" + name + "_noisy.ply");
  if (!noisy) return noisy.error();
  auto truth = loadMesh(folder + "/" + name + "_original.ply");
  if (!truth) return truth.error();
  Pair pair;
  pair.name = name;
  pair.noisy = std::move(noisy->vertices);
  pair.truth = std::move(truth->vertices);
  pair.faces = std::move(noisy->faces);
  if (pair.noisy.size() != pair.truth.size()) {
    return Error{ErrorCode::kBadInput, "'" + name + "' is no pair of meshes of the same vertices"};
  }
  pair.edge = meanEdge(pair.truth, pair.faces);
  return pair;
}

Error saveMesh(const std::string& path, const Points& vertices, const MeshFaces& faces) {
  PointFile file;
  for (const char* name : {"x", "y", "z"}) addField(file.cloud, name, kFloat32);
  file.cloud.resize(vertices.size());
  std::uint8_t* at = file.cloud.data.data();
  for (const Vector3& p : vertices) {
    for (const double coordinate : p) {
      const auto value = static_cast<float>(coordinate);
      std::memcpy(at, &value, sizeof(value));
      at += sizeof(value);
    }
  }
  file.face_begin = faces.begin;
  file.face_vertices = faces.corners;
  return savePointFile(path, file);
}

Points faceNormals(const Points& vertices, const MeshFaces& faces) {
  Points normals(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    normals[f] = normalized(areaVector(vertices, faces[f]));
  }
  return normals;
}

Points faceCentroids(const Points& vertices, const MeshFaces& faces) {
  Points centroids(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) centroids[f] = centroid(vertices, faces[f]);
  return centroids;
}

std::vector<double> faceAreas(const Points& vertices, const MeshFaces& faces) {
  std::vector<double> areas(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) areas[f] = length(areaVector(vertices, faces[f]));
  return areas;
}

double meanCentroidDistance(const Points& centroids, const MeshTopology& topology) {
  double sum = 0, count = 0;
  for (std::size_t f = 0; f < centroids.size(); ++f) {
    for (const std::uint32_t g : topology.acrossEdges(f)) {
      sum += length(subtract(centroids[f], centroids[g]));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

double meanEdge(const Points& vertices, const MeshFaces& faces) {
  double sum = 0, count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      sum += length(subtract(vertices[corners[k]], vertices[corners[(k + 1) % corners.size()]]));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace pcl_slim::mesh_bench

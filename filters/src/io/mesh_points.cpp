// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_points.h"

#include <cstring>
#include <string>

namespace pcl_slim {

namespace {

Error checkMesh(const MeshPoints& mesh, const std::string& format) {
  const std::size_t n = mesh.positions.size();
  if (n > 0xfffffffeu || mesh.face_vertices.size() > 0xffffffffu)
    return badInput("the " + format + " file has more than 2^32 - 2 vertices or corners; split it");
  for (const std::uint32_t vertex : mesh.face_vertices) {
    if (vertex >= n) {
      return badInput("a face of the " + format + " file names vertex " + std::to_string(vertex) +
                      " of " + std::to_string(n) + ", counted from 0; write it again");
    }
  }
  return {};
}

void layOut(const MeshPoints& mesh, PointTable& cloud) {
  for (const char* axis : {"x", "y", "z"})
    addField(cloud, axis, mesh.in_float ? kFloat32 : kFloat64);
  if (!mesh.normals.empty()) {
    for (const char* axis : {"normal_x", "normal_y", "normal_z"}) addField(cloud, axis, kFloat32);
  }
  if (!mesh.colors.empty()) addField(cloud, "rgb", kFloat32);
  cloud.resize(mesh.positions.size());
}

}  // namespace

void MeshPoints::endFace() {
  if (face_begin.empty()) face_begin.push_back(0);
  face_begin.push_back(static_cast<std::uint32_t>(face_vertices.size()));
}

Result<PointFile> toPointFile(const MeshPoints& mesh, const char* format) {
  if (Error error = checkMesh(mesh, format)) return error;
  PointFile file;
  layOut(mesh, file.cloud);
  std::uint8_t* at = file.cloud.data.data();
  const auto put = [&at](const auto& value) {
    std::memcpy(at, &value, sizeof(value));
    at += sizeof(value);
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const double coordinate : mesh.positions[i]) {
      if (mesh.in_float)
        put(static_cast<float>(coordinate));
      else
        put(coordinate);
    }
    if (!mesh.normals.empty()) put(mesh.normals[i]);
    if (mesh.colors.empty()) continue;
    const auto& c = mesh.colors[i];
    put(std::array<std::uint8_t, 4>{c[2], c[1], c[0], 0});
  }
  file.face_begin = mesh.face_begin;
  file.face_vertices = mesh.face_vertices;
  return file;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "smoothing/smoothing_run.h"
#include "topology/edge_census.h"

namespace pcl_slim {

namespace {

std::vector<Vector3>
positionsOf(const CloudView& cloud)
{
  std::vector<Vector3> made(cloud.size);
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto* at = static_cast<const unsigned char*>(cloud.xyz) + i * cloud.xyz_stride;
    if (cloud.scalar == CloudView::Scalar::kDouble) {
      std::memcpy(made[i].data(), at, sizeof(Vector3));
      continue;
    }
    float p[3];
    std::memcpy(p, at, sizeof(p));
    made[i] = {p[0], p[1], p[2]};
  }
  return made;
}

bool
isFinite(const Vector3& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

bool
isUsable(const std::vector<Vector3>& vertices, IndexRow corners)
{
  if (corners.size() < 3) return false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!isFinite(vertices[corners[k]])) return false;
    if (std::find(corners.begin(), corners.begin() + k, corners[k]) != corners.begin() + k) {
      return false;
    }
  }
  return true;
}

/** Faces that can be used, and which they are of those given. */
struct UsedFaces {
  MeshFaces faces;
  std::vector<std::uint32_t> given;
};

UsedFaces
usedFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces)
{
  UsedFaces used;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!isUsable(vertices, faces[f])) continue;
    used.faces.add(faces[f].begin(), faces[f].size());
    used.given.push_back(static_cast<std::uint32_t>(f));
  }
  return used;
}

Error
checkInput(const CloudView& cloud, const MeshFaces& faces, const MeshSmoothParams& params,
           const SLIMSurface* surface)
{
  if (Error error = params.validate()) return error;
  if (cloud.size == 0) return {ErrorCode::kBadInput, "the mesh has no vertices; give one that has"};
  if (Error error = cloud.validate()) return error;
  if (faces.size() == 0) {
    return {ErrorCode::kBadInput,
            "the mesh has no faces; smooth its points as a cloud, or give one that has"};
  }
  if (Error error = faces.validate(cloud.size)) return error;
  return surface != nullptr ? surface->validate() : Error();
}

/** Counts what became of the vertices. */
void
countVertices(const std::vector<Vector3>& before, const SmoothedMesh& after, const MeshFaces& used,
              MeshSmoothStatistics& s)
{
  std::vector<std::uint8_t> named(before.size());
  for (const std::uint32_t v : used.corners) named[v] = 1;
  double sum = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (!isFinite(before[v])) {
      ++s.non_finite;
      continue;
    }
    if (named[v] == 0) ++s.isolated;
    if (after.vertices[v] == before[v]) continue;
    const double distance = length(subtract(after.vertices[v], before[v]));
    ++s.moved;
    sum += distance * distance;
    s.max_displacement = std::max(s.max_displacement, distance);
  }
  s.rms_displacement = s.moved > 0 ? std::sqrt(sum / static_cast<double>(s.moved)) : 0;
}

Error
noUsableFace(std::size_t faces)
{
  return {ErrorCode::kBadInput,
          "none of " + std::to_string(faces) +
              " faces has three different finite corners; give a mesh that has some"};
}

}  // namespace

Error
smoothMesh(const CloudView& cloud, const MeshFaces& faces, const MeshSmoothParams& params,
           const SLIMSurface* surface, SmoothedMesh& result, MeshSmoothStatistics* statistics,
           SLIMSurface* fitted, Progress* progress)
{
  MeshSmoothStatistics own;
  MeshSmoothStatistics& s = statistics != nullptr ? *statistics : own;
  s = {};
  result = {};
  if (fitted != nullptr) *fitted = {};
  if (Error error = checkInput(cloud, faces, params, surface)) return error;
  const std::vector<Vector3> vertices = positionsOf(cloud);
  const UsedFaces used = usedFaces(vertices, faces);
  s.faces = faces.size();
  s.faces_left_out = faces.size() - used.given.size();
  if (used.given.empty()) return noUsableFace(faces.size());
  detail::countEdges(used.faces, s.disagreeing_edges, s.nonmanifold_edges);
  detail::SmoothingRun run(used.faces, vertices, params, surface, s, progress);
  if (Error error = run.run()) return error;
  // Asked for after the last place where anyone looks: whoever cancels wants no result.
  if (progress != nullptr && progress->cancelled()) {
    return {ErrorCode::kCancelled, "the smoothing was cancelled"};
  }
  result.vertices = run.vertices();
  result.normals = run.vertexNormals();
  result.face_normals.assign(faces.size(), Vector3{});
  for (std::size_t f = 0; f < used.given.size(); ++f) {
    result.face_normals[used.given[f]] = run.normals()[f];
  }
  s.held = static_cast<std::uint64_t>(std::count(run.held().begin(), run.held().end(), 1));
  countVertices(vertices, result, used.faces, s);
  if (fitted != nullptr && surface == nullptr) *fitted = run.takeFitted();
  return {};
}

}  // namespace pcl_slim

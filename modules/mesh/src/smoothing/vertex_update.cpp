// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing/vertex_update.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kChunk = 512;
/** Faces that agree less with their normals are about to turn over: 84 degrees. */
constexpr double kLeastAgreement = 0.1;

/** Cosine of the angle between a face and the normal it shall have; 0 without area. */
double
agreement(const MovingMesh& mesh, const std::vector<Vector3>& vertices, const Vector3& normal,
          std::size_t f)
{
  return dot(normalized(areaVector(vertices, mesh.faces[f])), normal);
}

/** Whether a step brings a face close to turning over, or leads one on that has turned. */
bool
turnsOver(const MovingMesh& mesh, const std::vector<Vector3>& before, const Vector3& normal,
          std::size_t f)
{
  const double after = agreement(mesh, mesh.vertices, normal, f);
  return after < kLeastAgreement && after < agreement(mesh, before, normal, f);
}

/** Moves vertices back where a face turns over, until none does. */
void
takeBack(const std::vector<Vector3>& normals, const std::vector<Vector3>& before,
         const MovingMesh& mesh)
{
  std::vector<std::uint32_t> turned(mesh.faces.size());
  for (std::size_t f = 0; f < turned.size(); ++f) turned[f] = static_cast<std::uint32_t>(f);
  while (!turned.empty()) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t f : turned) {
      if (!turnsOver(mesh, before, normals[f], f)) continue;
      for (const std::uint32_t v : mesh.faces[f]) {
        if (mesh.vertices[v] == before[v]) continue;
        mesh.vertices[v] = before[v];
        mesh.held[v] = 1;
        // The other faces at this vertex have changed again.
        const IndexRow around = mesh.topology.facesOf(v);
        next.insert(next.end(), around.begin(), around.end());
      }
    }
    turned.swap(next);
  }
}

/** A place half way to the middle of the other corners of a vertex's faces, along the surface. */
Vector3
nearerToNeighbours(const std::vector<Vector3>& normals, const MovingMesh& mesh, std::size_t v)
{
  Vector3 sum{}, normal{};
  double count = 0;
  for (const std::uint32_t f : mesh.topology.facesOf(v)) {
    normal = along(normal, 1, normals[f]);
    for (const std::uint32_t other : mesh.faces[f]) {
      if (other == v) continue;
      sum = along(sum, 1, mesh.vertices[other]);
      ++count;
    }
  }
  normal = normalized(normal);
  const Vector3 step = subtract(scaled(sum, 1 / count), mesh.vertices[v]);
  return along(along(mesh.vertices[v], 0.5, step), -0.5 * dot(step, normal), normal);
}

}  // namespace

void
unfold(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh)
{
  for (int i = 0; i < steps; ++i) {
    std::vector<std::uint32_t> corners;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (agreement(mesh, mesh.vertices, normals[f], f) >= kLeastAgreement) continue;
      corners.insert(corners.end(), mesh.faces[f].begin(), mesh.faces[f].end());
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<Vector3> places;
    for (const std::uint32_t v : corners) places.push_back(nearerToNeighbours(normals, mesh, v));
    for (std::size_t k = 0; k < corners.size(); ++k) mesh.vertices[corners[k]] = places[k];
  }
}

void
followNormals(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh)
{
  const int threads = resolveThreads(mesh.threads);
  std::vector<Vector3> centroids(mesh.faces.size());
  for (int i = 0; i < steps; ++i) {
    const std::vector<Vector3> before = mesh.vertices;
    parallelFor(centroids.size(), threads, kChunk,
                [&](std::size_t f, int) { centroids[f] = centroid(before, mesh.faces[f]); });
    parallelFor(before.size(), threads, kChunk, [&](std::size_t v, int) {
      const IndexRow own = mesh.topology.facesOf(v);
      Vector3 step{};
      for (const std::uint32_t f : own) {
        step = along(step, dot(normals[f], subtract(centroids[f], before[v])), normals[f]);
      }
      if (own.size() > 0) {
        mesh.vertices[v] = along(before[v], 1.0 / static_cast<double>(own.size()), step);
      }
    });
    takeBack(normals, before, mesh);
  }
}

void
minimiseQuadrics(const std::vector<Vector3>& places, const std::vector<Vector3>& normals,
                 const std::vector<double>& areas, double regularity, const MovingMesh& mesh)
{
  const std::vector<Vector3> before = mesh.vertices;
  parallelFor(before.size(), resolveThreads(mesh.threads), kChunk, [&](std::size_t v, int) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double total = 0;
    for (const std::uint32_t f : mesh.topology.facesOf(v)) {
      const Eigen::Map<const Eigen::Vector3d> n(normals[f].data());
      a += areas[f] * n * n.transpose();
      b += areas[f] * dot(normals[f], subtract(places[f], before[v])) * n;
      total += areas[f];
    }
    if (!(total > 0)) return;
    a.diagonal().array() += regularity * total;
    const Eigen::Vector3d step = a.ldlt().solve(b);
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.vertices[v][k] = before[v][k] + step[static_cast<Eigen::Index>(k)];
    }
  });
  takeBack(normals, before, mesh);
}

}  // namespace pcl_slim::detail

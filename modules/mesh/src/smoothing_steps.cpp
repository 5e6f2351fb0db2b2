// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing_steps.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kMeasureChunk = 1024;  ///< faces or vertices a thread takes at a time

}  // namespace

FaceGeometry measureFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces,
                          int threads) {
  FaceGeometry made;
  made.centroids.resize(faces.size());
  made.normals.resize(faces.size());
  made.areas.resize(faces.size());
  parallelFor(faces.size(), resolveThreads(threads), kMeasureChunk, [&](std::size_t f, int) {
    const Vector3 area = areaVector(vertices, faces[f]);
    made.centroids[f] = centroid(vertices, faces[f]);
    made.areas[f] = length(area);
    made.normals[f] = normalized(area);
  });
  return made;
}

std::vector<Vector3> vertexNormals(const FaceGeometry& geometry,
                                   const std::vector<Vector3>& face_normals,
                                   const MeshTopology& topology, std::size_t num_vertices,
                                   int threads) {
  std::vector<Vector3> made(num_vertices);
  parallelFor(num_vertices, resolveThreads(threads), kMeasureChunk, [&](std::size_t v, int) {
    Vector3 sum{};
    for (const std::uint32_t f : topology.facesOf(v)) {
      sum = along(sum, geometry.areas[f], face_normals[f]);
    }
    made[v] = normalized(sum);
  });
  return made;
}

double meanEdgeLength(const std::vector<Vector3>& vertices, const MeshFaces& faces) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k, ++count) {
      sum += length(subtract(vertices[corners[k]], vertices[corners[(k + 1) % corners.size()]]));
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

double sharpShare(const std::vector<Vector3>& normals, const MeshTopology& topology) {
  constexpr double kSharp = M_PI / 6;
  double all = 0, sharp = 0;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    for (const std::uint32_t g : topology.acrossEdges(f)) {
      if (g < f) continue;
      const double angle = std::acos(std::clamp(dot(normals[f], normals[g]), -1.0, 1.0));
      all += angle;
      if (angle > kSharp) sharp += angle;
    }
  }
  return all > 0 ? sharp / all : 0;
}

std::vector<Vector3> filterNormals(const NormalFilter& filter, const std::vector<Vector3>& guide,
                                   const std::vector<Vector3>& normals) {
  std::vector<Vector3> made(normals.size());
  const double factor = -0.5 / (filter.range * filter.range);
  parallelFor(normals.size(), resolveThreads(filter.threads), 256, [&](std::size_t f, int) {
    Vector3 sum = scaled(normals[f], filter.geometry.areas[f]);
    for (const std::uint32_t g : filter.topology.around(f)) {
      const Vector3 step = subtract(guide[g], guide[f]);
      sum = along(sum, filter.geometry.areas[g] * std::exp(factor * dot(step, step)), normals[g]);
    }
    const double size = length(sum);
    made[f] = size > 0 ? scaled(sum, 1 / size) : normals[f];
  });
  return made;
}

std::vector<Vector3> ringNormals(const NormalFilter& filter, const std::vector<Vector3>& normals) {
  std::vector<Vector3> made(normals.size());
  parallelFor(normals.size(), resolveThreads(filter.threads), 256, [&](std::size_t f, int) {
    Vector3 sum{};
    for (const std::uint32_t g : filter.topology.around(f)) {
      sum = along(sum, filter.geometry.areas[g], normals[g]);
    }
    made[f] = normalized(sum);
  });
  return made;
}

void mendLoneNormals(const NormalFilter& filter, std::vector<Vector3>& normals) {
  const std::vector<Vector3> ring = ringNormals(filter, normals);
  constexpr double kLeast = 0.4;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    if (ring[f] != Vector3{} && dot(ring[f], normals[f]) < kLeast) normals[f] = ring[f];
  }
}

void pullNormals(const std::vector<Vector3>& others, double weight, std::vector<Vector3>& normals) {
  for (std::size_t f = 0; f < normals.size(); ++f) {
    normals[f] = normalized(along(normals[f], weight, others[f]));
  }
}

namespace {

constexpr std::size_t kMoveChunk = 512;
/** Faces that agree less with their normals are about to turn over: 84 degrees. */
constexpr double kLeastAgreement = 0.1;

/** Cosine of the angle between a face and the normal it shall have; 0 without area. */
double agreement(const MovingMesh& mesh, const std::vector<Vector3>& vertices,
                 const Vector3& normal, std::size_t f) {
  return dot(normalized(areaVector(vertices, mesh.faces[f])), normal);
}

/** Whether a step brings a face close to turning over, or leads one on that has turned. */
bool turnsOver(const MovingMesh& mesh, const std::vector<Vector3>& before, const Vector3& normal,
               std::size_t f) {
  const double after = agreement(mesh, mesh.vertices, normal, f);
  return after < kLeastAgreement && after < agreement(mesh, before, normal, f);
}

/** Moves vertices back where a face turns over, until none does. */
void takeBack(const std::vector<Vector3>& normals, const std::vector<Vector3>& before,
              const MovingMesh& mesh) {
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
Vector3 nearerToNeighbours(const std::vector<Vector3>& normals, const MovingMesh& mesh,
                           std::size_t v) {
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

void unfold(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh) {
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

void followNormals(const std::vector<Vector3>& normals, int steps, const MovingMesh& mesh) {
  const int threads = resolveThreads(mesh.threads);
  std::vector<Vector3> centroids(mesh.faces.size());
  for (int i = 0; i < steps; ++i) {
    const std::vector<Vector3> before = mesh.vertices;
    parallelFor(centroids.size(), threads, kMoveChunk,
                [&](std::size_t f, int) { centroids[f] = centroid(before, mesh.faces[f]); });
    parallelFor(before.size(), threads, kMoveChunk, [&](std::size_t v, int) {
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

void minimiseQuadrics(const std::vector<Vector3>& places, const std::vector<Vector3>& normals,
                      const std::vector<double>& areas, double regularity, const MovingMesh& mesh) {
  const std::vector<Vector3> before = mesh.vertices;
  parallelFor(before.size(), resolveThreads(mesh.threads), kMoveChunk, [&](std::size_t v, int) {
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

// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/measures.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::mesh_bench {

namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kSharp = 40 / kDegrees;

double angleBetween(const Vector3& a, const Vector3& b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

comparison::MeshSurface surfaceOf(const Points& vertices, const MeshFaces& faces) {
  std::vector<comparison::MeshSurface::Triangle> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 2; k < faces[f].size(); ++k) {
      triangles.push_back({faces[f][0], faces[f][k - 1], faces[f][k]});
    }
  }
  return {vertices, std::move(triangles)};
}

/** Six times the volume within a closed mesh, relative to a point; what faces cover is counted. */
double volumeOf(const Points& vertices, const MeshFaces& faces, const Vector3& middle) {
  double sum = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    sum += dot(areaVector(vertices, faces[f]), subtract(vertices[faces[f][0]], middle));
  }
  return sum;
}

}  // namespace

Comparison::Comparison(const Pair& pair)
    : pair_(pair),
      surface_(surfaceOf(pair.truth, pair.faces)),
      topology_(pair.faces, pair.truth.size()),
      normals_(faceNormals(pair.truth, pair.faces)),
      noisy_normals_(faceNormals(pair.noisy, pair.faces)),
      sides_(pair.faces.size()),
      sharp_(sharpVertices()) {
  for (std::size_t f = 0; f < sides_.size(); ++f) {
    sides_[f] = areaVector(pair.truth, pair.faces[f]);
    for (const std::uint32_t g : topology_.around(f)) {
      sides_[f] = along(sides_[f], 1, areaVector(pair.truth, pair.faces[g]));
    }
  }
}

std::vector<std::uint8_t> Comparison::sharpVertices() const {
  std::vector<std::uint8_t> sharp(pair_.truth.size());
  for (std::size_t v = 0; v < sharp.size(); ++v) {
    for (const std::uint32_t f : topology_.facesOf(v)) {
      for (const std::uint32_t g : topology_.facesOf(v)) {
        if (angleBetween(normals_[f], normals_[g]) > kSharp) sharp[v] = 1;
      }
    }
  }
  return sharp;
}

void Comparison::measureFaces(const Points& smoothed, Measures& m) const {
  const Points made = faceNormals(smoothed, pair_.faces);
  double sharp = 0;
  for (std::size_t f = 0; f < made.size(); ++f) {
    m.angle += kDegrees * angleBetween(normals_[f], made[f]) / static_cast<double>(made.size());
    const bool folded = dot(sides_[f], made[f]) <= 0;
    m.folded += folded;
    m.newly_folded += folded && dot(sides_[f], noisy_normals_[f]) > 0;
    for (const std::uint32_t g : topology_.acrossEdges(f)) {
      const double was = angleBetween(normals_[f], normals_[g]);
      if (g < f || was < kSharp) continue;
      m.sharp_angle += kDegrees * std::abs(angleBetween(made[f], made[g]) - was);
      ++sharp;
    }
  }
  if (sharp > 0) m.sharp_angle /= sharp;
}

Measures Comparison::of(const Points& smoothed) const {
  Measures m;
  std::vector<double> distances(smoothed.size());
  parallelFor(smoothed.size(), resolveThreads(0), 1024,
              [&](std::size_t v, int) { distances[v] = surface_.nearest(smoothed[v]).distance; });
  double num_sharp = 0;
  Vector3 middle{};
  const auto count = static_cast<double>(smoothed.size());
  for (std::size_t v = 0; v < smoothed.size(); ++v) {
    const double d = distances[v];
    const Vector3 step = subtract(smoothed[v], pair_.truth[v]);
    m.surface_rms += d * d / count;
    m.vertex_rms += dot(step, step) / count;
    m.sharp_rms += sharp_[v] ? d * d : 0;
    num_sharp += sharp_[v];
    middle = along(middle, 1 / count, pair_.truth[v]);
  }
  m.surface_rms = std::sqrt(m.surface_rms) / pair_.edge;
  m.vertex_rms = std::sqrt(m.vertex_rms) / pair_.edge;
  m.sharp_rms = num_sharp > 0 ? std::sqrt(m.sharp_rms / num_sharp) / pair_.edge : 0;
  m.volume =
      volumeOf(smoothed, pair_.faces, middle) / volumeOf(pair_.truth, pair_.faces, middle) - 1;
  measureFaces(smoothed, m);
  return m;
}

}  // namespace pcl_slim::mesh_bench

// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/measures.h"

#include <algorithm>
#include <cmath>

#include "benchmark/mesh_surface.h"

namespace pcl_slim::mesh_bench {

namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kSharp = 40 / kDegrees;

double
angleBetween(const Vector3& a, const Vector3& b)
{
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

comparison::MeshSurface
surfaceOf(const Points& vertices, const MeshFaces& faces)
{
  std::vector<comparison::MeshSurface::Triangle> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 2; k < faces[f].size(); ++k) {
      triangles.push_back({faces[f][0], faces[f][k - 1], faces[f][k]});
    }
  }
  return {vertices, std::move(triangles)};
}

/** Six times the volume within a closed mesh, relative to a point; what faces cover is counted. */
double
volumeOf(const Points& vertices, const MeshFaces& faces, const Vector3& middle)
{
  double sum = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    sum += dot(areaVector(vertices, faces[f]), subtract(vertices[faces[f][0]], middle));
  }
  return sum;
}

void
measureFaces(const Pair& pair, const Points& smoothed, Measures& m)
{
  const Points truth = faceNormals(pair.truth, pair.faces);
  const Points made = faceNormals(smoothed, pair.faces);
  const Points before = faceNormals(pair.noisy, pair.faces);
  const MeshTopology topology(pair.faces, pair.truth.size());
  double sharp = 0;
  for (std::size_t f = 0; f < truth.size(); ++f) {
    const double angle = angleBetween(truth[f], made[f]);
    m.angle += kDegrees * angle / static_cast<double>(truth.size());
    Vector3 side = areaVector(pair.truth, pair.faces[f]);
    for (const std::uint32_t g : topology.around(f)) {
      side = along(side, 1, areaVector(pair.truth, pair.faces[g]));
    }
    const bool folded = dot(side, made[f]) <= 0;
    m.folded += folded;
    m.newly_folded += folded && dot(side, before[f]) > 0;
    for (const std::uint32_t g : topology.acrossEdges(f)) {
      const double was = angleBetween(truth[f], truth[g]);
      if (g < f || was < kSharp) continue;
      m.sharp_angle += kDegrees * std::abs(angleBetween(made[f], made[g]) - was);
      ++sharp;
    }
  }
  if (sharp > 0) m.sharp_angle /= sharp;
}

/** Vertices at which two faces of the original part by more than 40 degrees. */
std::vector<std::uint8_t>
sharpVertices(const Pair& pair)
{
  const Points normals = faceNormals(pair.truth, pair.faces);
  const MeshTopology topology(pair.faces, pair.truth.size());
  std::vector<std::uint8_t> sharp(pair.truth.size());
  for (std::size_t v = 0; v < sharp.size(); ++v) {
    for (const std::uint32_t f : topology.facesOf(v)) {
      for (const std::uint32_t g : topology.facesOf(v)) {
        if (angleBetween(normals[f], normals[g]) > kSharp) sharp[v] = 1;
      }
    }
  }
  return sharp;
}

}  // namespace

Measures
compare(const Pair& pair, const Points& smoothed)
{
  Measures m;
  const comparison::MeshSurface surface = surfaceOf(pair.truth, pair.faces);
  const std::vector<std::uint8_t> sharp = sharpVertices(pair);
  double num_sharp = 0;
  Vector3 middle{};
  const auto count = static_cast<double>(smoothed.size());
  for (std::size_t v = 0; v < smoothed.size(); ++v) {
    const double d = surface.nearest(smoothed[v]).distance;
    const Vector3 step = subtract(smoothed[v], pair.truth[v]);
    m.surface_rms += d * d / count;
    m.vertex_rms += dot(step, step) / count;
    m.sharp_rms += sharp[v] ? d * d : 0;
    num_sharp += sharp[v];
    middle = along(middle, 1 / count, pair.truth[v]);
  }
  m.surface_rms = std::sqrt(m.surface_rms) / pair.edge;
  m.vertex_rms = std::sqrt(m.vertex_rms) / pair.edge;
  m.sharp_rms = num_sharp > 0 ? std::sqrt(m.sharp_rms / num_sharp) / pair.edge : 0;
  m.volume = volumeOf(smoothed, pair.faces, middle) / volumeOf(pair.truth, pair.faces, middle) - 1;
  measureFaces(pair, smoothed, m);
  return m;
}

}  // namespace pcl_slim::mesh_bench

// SPDX-License-Identifier: BSD-3-Clause
// Bytes of a surface beside those of its points, rounded and not (the abstract's compactness).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "comparison/mesh_surface.h"
#include "paper/study.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim::paper {

namespace {

struct Scan {
  const char* file;
  bool meshed;  ///< is compared with a mesh
};
constexpr Scan kScans[] = {
    {"stanford_bunny_zipper.ply", true},    {"armadillo_50k.ply", true},
    {"stanford_dragon_res2.ply", true},     {"lion_takanawa.pcd", true},
    {"stanford_bunny_raw_scans.pcd", true}, {"azure_kinect_organized.pcd", false},
};
constexpr double kPi = 3.14159265358979323846;
constexpr double kAllowed = 1.02;     ///< times the error of the finest mesh
constexpr double kFloatBytes = 12.0;  ///< of a point: x, y, z

/** Median and 95th percentile of the angles between two projections' normals, degrees. */
std::array<double, 2> turned(const Projection& before, const Projection& after) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < before.normal.size(); ++i) {
    const auto &p = before.normal[i], &q = after.normal[i];
    const Vector3 a = {p[0], p[1], p[2]}, b = {q[0], q[1], q[2]};
    angles.push_back(std::atan2(length(cross(a, b)), std::abs(dot(a, b))) * 180.0 / kPi);
  }
  std::sort(angles.begin(), angles.end());
  return {angles[angles.size() / 2], angles[angles.size() * 19 / 20]};
}

/** RMS distance of a model's points from a mesh, as a share of the diagonal. */
double meshError(const Model& model, const TriangleMesh& mesh, double diagonal) {
  const comparison::MeshSurface surface(mesh.vertices, mesh.triangles);
  double sum = 0;
  for (const Vector3& p : model.points) {
    const double d = surface.nearest(p).distance;
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(model.points.size())) / diagonal;
}

/** The mesh of fewest triangles that the points are at most kAllowed times as far from as from the
 * finest. */
Error smallestMesh(const Model& model, const Fitted& fitted, int threads, TriangleMesh& best) {
  MeshParams params;
  params.threads = threads;
  params.min_component_points = 0;
  const double diagonal = fitted.store.diagonal() * fitted.store.scale();
  if (Error error = extractMesh(fitted.surface, params, best)) return error;
  const double allowed = kAllowed * meshError(model, best, diagonal);
  double low = 0, high = static_cast<double>(best.triangles.size());
  for (int step = 0; step < 7; ++step) {
    const double middle = 0.5 * (low + high);
    params.max_triangles = static_cast<std::uint64_t>(middle);
    TriangleMesh mesh;
    if (Error error = extractMesh(fitted.surface, params, mesh)) return error;
    const bool good = meshError(model, mesh, diagonal) <= allowed;
    (good ? high : low) = middle;
    if (good) best = std::move(mesh);
  }
  return {};
}

/** A mesh as a binary PLY of floats and 32-bit indices. */
std::string plyOf(const TriangleMesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.vertices.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.triangles.size()) +
                     "\nproperty list uchar uint vertex_indices\nend_header\n";
  const auto put = [&text](auto value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    text.append(bytes, sizeof(value));
  };
  for (const Vector3& p : mesh.vertices) {
    for (const double x : p) put(static_cast<float>(x));
  }
  for (const auto& triangle : mesh.triangles) {
    put(static_cast<unsigned char>(3));
    for (const std::uint32_t corner : triangle) put(corner);
  }
  return text;
}

Error addModel(const Model& model, bool compact, bool meshed, const StudySettings& settings,
               Table& table) {
  FitParams params;
  params.threads = settings.threads;
  if (compact) params.cover_radius = 1.0;
  auto fitted = fitModel(model, params);
  if (!fitted) return fitted.error();
  const double error = projectionError(*fitted);
  if (meshed) {
    TriangleMesh mesh;
    if (Error e = smallestMesh(model, *fitted, settings.threads, mesh)) return e;
    const std::string ply = plyOf(mesh), path = settings.out + "/" + model.name + ".ply";
    if (Error e = writeFile(path, ply.data(), ply.size())) return e;
    std::printf("%s: %zu triangles for %g times the error, %zu bytes of PLY\n", path.c_str(),
                mesh.triangles.size(), kAllowed, ply.size());
  }
  const double cloud = kFloatBytes * static_cast<double>(model.points.size());
  const Projection exact = fitted->projection;
  const SLIMSurface surface = fitted->surface;
  for (const double rounding : {0.0, 0.03, 0.1, 0.3}) {
    const auto bytes = encodeSlim(surface, rounding);
    auto decoded = decodeSlim(bytes.data(), bytes.size());
    if (!decoded) return decoded.error();
    fitted->surface = std::move(*decoded);
    ProjectionParams how;
    how.curvature = true;
    how.threads = settings.threads;
    if (Error e = projectPoints(fitted->store, fitted->surface, how, fitted->projection)) return e;
    const auto size = static_cast<double>(bytes.size());
    const auto angles = turned(exact, fitted->projection);
    table.row({model.name + (compact ? ", -compact 1" : ""), std::to_string(model.points.size()),
               std::to_string(surface.size()), number("%g", rounding), number("%.0f", size),
               number("%.1f", size / static_cast<double>(surface.size())),
               number("%.3f", size / cloud), number("%.2e", error),
               number("%.4f", projectionError(*fitted) / error), number("%.3f", angles[0]),
               number("%.3f", angles[1])});
  }
  return {};
}

}  // namespace

Error compactness(const StudySettings& settings) {
  Table table("Bytes of a surface (compactness)",
              {"model", "points", "surfels", "rounding", "bytes", "a surfel", "of float x y z",
               "error / L", "times the error", "normals, median, degrees", "95th percentile"});
  for (const Scan& scan : kScans) {
    const auto model = loadModel(settings, scan.file);
    if (!model) return model.error();
    for (const bool compact : {false, true}) {
      if (Error error = addModel(*model, compact, scan.meshed && !compact, settings, table))
        return error;
    }
  }
  return table.save(settings, "compactness");
}

}  // namespace pcl_slim::paper

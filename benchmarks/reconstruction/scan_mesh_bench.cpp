// SPDX-License-Identifier: BSD-3-Clause
// A mesh file beside the scan it was made of, and beside the true mesh where there is one: how far
// it reaches beyond the points, which points it leaves out, and how far its triangles are from the
// truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "borders/drawn_area.h"
#include "common/options.h"
#include "comparison/mesh_surface.h"
#include "mesh/bench_mesh.h"
#include "pcl_slim/fit/fit.h"
#include "scan/cloud_file.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using mesh_bench::Mesh;

struct Settings {
  std::string mesh, scan, truth;
  int threads = 1;
};

constexpr double kDegrees = 180 / M_PI;
constexpr double kSharp = 40 / kDegrees;
constexpr double kLost = 0.5;  ///< spacings: as borders_bench
constexpr int kMostParts = 64;

/** Calls use(place, area) for places spread over a triangle no farther apart than step. */
template <typename Use>
void forPlaces(const Mesh& mesh, IndexRow corners, double step, const Use& use) {
  const Vector3 a = mesh.vertices[corners[0]];
  const Vector3 u = subtract(mesh.vertices[corners[1]], a);
  const Vector3 v = subtract(mesh.vertices[corners[2]], a);
  const double longest = std::max({length(u), length(v), length(subtract(v, u))});
  const int parts = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, kMostParts);
  const double area = 0.5 * length(cross(u, v)) / (parts * parts);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      for (int down = 0; down < (i + j < parts - 1 ? 2 : 1); ++down) {
        const double shift = (1.0 + down) / 3;
        use(along(along(a, (i + shift) / parts, u), (j + shift) / parts, v), area);
      }
    }
  }
}

comparison::MeshSurface surfaceOf(const Mesh& mesh) {
  std::vector<comparison::MeshSurface::Triangle> triangles;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t k = 2; k < mesh.faces[f].size(); ++k) {
      triangles.push_back({mesh.faces[f][0], mesh.faces[f][k - 1], mesh.faces[f][k]});
    }
  }
  return {mesh.vertices, std::move(triangles)};
}

/** Distances from one mesh to another, in the unit given. */
void printDistances(const char* name, const Mesh& from, const Mesh& to, double unit) {
  const comparison::MeshSurface surface = surfaceOf(to);
  double squares = 0, total = 0, most = 0;
  for (std::size_t f = 0; f < from.faces.size(); ++f) {
    forPlaces(from, from.faces[f], unit / 2, [&](const Vector3& place, double area) {
      const double d = surface.nearest(place).distance / unit;
      squares += area * d * d;
      total += area;
      most = std::max(most, d);
    });
  }
  std::printf("  %s: RMS %.4f, most %.3f mean edges\n", name, std::sqrt(squares / total), most);
}

/** Distances of the truth's sharp edges (40 degrees and more) from the mesh. */
void printSharpEdges(const Mesh& truth, const Mesh& mesh, double unit) {
  const comparison::MeshSurface surface = surfaceOf(mesh);
  const mesh_bench::Points normals = mesh_bench::faceNormals(truth.vertices, truth.faces);
  const MeshTopology topology(truth.faces, truth.vertices.size());
  double squares = 0, count = 0;
  for (std::size_t v = 0; v < truth.vertices.size(); ++v) {
    bool sharp = false;
    for (const std::uint32_t f : topology.facesOf(v)) {
      for (const std::uint32_t g : topology.facesOf(v)) {
        sharp = sharp || dot(normals[f], normals[g]) < std::cos(kSharp);
      }
    }
    if (!sharp) continue;
    const double d = surface.nearest(truth.vertices[v]).distance / unit;
    squares += d * d;
    ++count;
  }
  if (count > 0) std::printf("  sharp edges to mesh: RMS %.4f\n", std::sqrt(squares / count));
}

Error compareWithTruth(const Settings& s, const Mesh& mesh) {
  const auto truth = mesh_bench::loadMesh(s.truth);
  if (!truth) return truth.error();
  const double edge = mesh_bench::meanEdge(truth->vertices, truth->faces);
  printDistances("mesh to truth", mesh, *truth, edge);
  printDistances("truth to mesh", *truth, mesh, edge);
  printSharpEdges(*truth, mesh, edge);
  return {};
}

/** Where data are, as the scan's default fit shows. */
Result<borders::Feet> feetOfScan(const Settings& s) {
  const auto cloud = loadCloudFile(s.scan);
  if (!cloud) return cloud.error();
  const auto store = PointStore::build(cloud->view(true), s.threads);
  if (!store) return store.error();
  FitParams fit;
  fit.threads = s.threads;
  SLIMSurface fitted;
  if (Error error = fitSurface(*store, fit, fitted)) return error;
  return borders::feetOf(*store, fitted, s.threads);
}

/** Overshoot and loss as borders_bench measures them of pictures, over the mesh's area. */
Error compareWithScan(const Settings& s, const Mesh& mesh) {
  const auto feet = feetOfScan(s);
  if (!feet) return feet.error();
  const borders::FootSearch search(*feet);
  const double scale = feet->store.scale();
  const double usual =
      scale * measure::median(std::vector<double>(feet->spacing.begin(), feet->spacing.end()));
  double total = 0, far = 0, lost = 0;
  std::vector<std::uint32_t> blocks;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    forPlaces(mesh, mesh.faces[f], usual / 2, [&](const Vector3& place, double area) {
      total += area;
      if (!search.isNear(place, blocks)) far += area;
    });
  }
  const comparison::MeshSurface surface = surfaceOf(mesh);
  const std::size_t count = feet->store.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 foot = along(feet->store.origin(), scale, feet->store.position(i));
    lost += surface.nearest(foot).distance > kLost * scale * feet->spacing[i] ? 1 : 0;
  }
  std::printf("  overshoot %.3f %% of the area, loss %.3f %% of %zu points\n", 100 * far / total,
              100 * lost / static_cast<double>(count), count);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("scan_mesh_bench", "1", "A mesh beside its scan and beside the truth.");
  options.positional("MESH.ply", &s.mesh, "made by pcl_slim_mesh or by another program");
  options.text("scan", &s.scan, "FILE", "the points it was made of");
  options.text("truth", &s.truth, "FILE", "the true mesh");
  options.integer("threads", &s.threads, 1, 4096, "threads");
  if (const auto status = options.parse(argc, argv)) return *status;
  const auto mesh = mesh_bench::loadMesh(s.mesh);
  Error error = mesh ? Error() : mesh.error();
  if (!error) {
    std::printf("%s: %zu triangles\n", s.mesh.c_str(), mesh->faces.size());
    if (!s.truth.empty()) error = compareWithTruth(s, *mesh);
    if (!error && !s.scan.empty()) error = compareWithScan(s, *mesh);
  }
  if (error) std::fprintf(stderr, "scan_mesh_bench: %s\n", error.message.c_str());
  return error ? kExitFailed : kExitDone;
}

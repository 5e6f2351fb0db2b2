// SPDX-License-Identifier: BSD-3-Clause
// Meshes of exact scenes beside their truth: SLIM's, pcl::Poisson's,
// pcl::GreedyProjectionTriangulation's and, where CGAL is installed, its Poisson reconstruction's.
#include <cmath>
#include <cstdio>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "reconstruction/rivals.h"
#include "support/lab/bench.h"
#include "support/lab/mesh_error.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::reconstruction_bench;

struct Settings {
  std::string shapes = "sphere,torus,bumpy,relief", noises = "0,0.001,0.005";
  std::string vectors = "best";
  int points = 100000, depth = 9, threads = 1;
  double tolerance = 1e-4;
  bool rivals = true, normals = true;
};

std::vector<std::string> splitList(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g %%", 100 * share);
  return text;
}

using Method = std::function<Error(const measure::Scene&, TriangleMesh&)>;

Error slim(const Settings& s, const measure::Scene& scene, TriangleMesh& mesh) {
  const auto store = PointStore::build(measure::viewOf(scene, nullptr, s.normals), s.threads);
  if (!store) return store.error();
  FitParams fit;
  fit.threads = s.threads;
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fit, surface)) return error;
  MeshParams params;
  params.threads = s.threads;
  params.tolerance = s.tolerance * scene.diagonal;
  return extractMesh(surface, params, mesh);
}

void printRow(const std::string& name, const Method& method, measure::Shape shape,
              const measure::Scene& scene) {
  TriangleMesh mesh;
  const measure::MemoryGauge memory;
  const double start = measure::cpuSeconds();
  const Error error = method(scene, mesh);
  const double seconds = measure::cpuSeconds() - start, peak = memory.peakBytes();
  if (error) {
    std::printf("| %s | %s |\n", name.c_str(), error.message.c_str());
    return;
  }
  const measure::MeshError e = measure::measureMesh(shape, mesh);
  const MeshCensus c = censusOf(mesh);
  std::printf("| %s | %.1e | %.1e | %.2f | %.1f | %lld | %llu | %llu | %.1f | %.0f |\n",
              name.c_str(), e.rms, e.max, e.normal, static_cast<double>(c.triangles) / 1000,
              static_cast<long long>(c.euler), static_cast<unsigned long long>(c.border_edges),
              static_cast<unsigned long long>(c.nonmanifold_edges + c.nonmanifold_vertices),
              1e6 * seconds / (static_cast<double>(scene.points.size()) / 3), peak / 1e6);
  std::fflush(stdout);
}

void printScene(const Settings& s, measure::Shape shape, const std::string& name, double noise) {
  const auto count = static_cast<std::size_t>(s.points);
  const measure::Scene scene = measure::makeScene(shape, count, noise, 0, 7);
  const std::string row = name + " " + percent(noise) + ", ";
  printRow(
      row + "SLIM", [&](const auto& from, auto& mesh) { return slim(s, from, mesh); }, shape,
      scene);
  if (!s.rivals) return;
  const double spacing = scene.diagonal / std::sqrt(static_cast<double>(count));
  printRow(
      row + "pcl::Poisson " + std::to_string(s.depth),
      [&](const auto& from, auto& mesh) { return poisson(from, s.depth, mesh); }, shape, scene);
  printRow(
      row + "GreedyProjection",
      [&](const auto& from, auto& mesh) { return greedyProjection(from, spacing, mesh); }, shape,
      scene);
  if (!hasCgal()) return;
  printRow(
      row + "CGAL Poisson",
      [&](const auto& from, auto& mesh) { return cgalPoisson(from, spacing, mesh); }, shape, scene);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options("reconstruction_bench", "1", "Meshes of exact scenes beside their truth.");
  options.text("shapes", &s.shapes, "A,B", "sphere, torus, bumpy, relief");
  options.text("noise", &s.noises, "A,B", "shares of the diagonal");
  options.integer("points", &s.points, 100, 10000000, "of each scene");
  options.integer("depth", &s.depth, 4, 12, "of pcl::Poisson");
  options.integer("threads", &s.threads, 1, 4096, "of SLIM");
  options.number("tol", &s.tolerance, 0, 1, "of SLIM, share of the diagonal; 0: its own");
  options.toggle("rivals", &s.rivals, "the other methods as well");
  options.toggle("normals", &s.normals, "give SLIM the normals that the others need");
  options.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  if (const auto status = options.parse(argc, argv)) return *status;
  if (Error error = measure::chooseVectors(s.vectors)) {
    std::fprintf(stderr, "reconstruction_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  measure::keepFreedMemory();
  std::printf(
      "| scene, noise, method | RMS | max | normals deg | triangles K | chi | border | "
      "nonmanifold | us/pt | MB |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : splitList(s.shapes)) {
    measure::Shape shape;
    if (!measure::parseShape(name, shape)) {
      std::fprintf(stderr, "reconstruction_bench: no scene '%s'\n", name.c_str());
      return kExitUsage;
    }
    for (const std::string& noise : splitList(s.noises)) {
      printScene(s, shape, name, std::stod(noise));
    }
  }
  return kExitDone;
}

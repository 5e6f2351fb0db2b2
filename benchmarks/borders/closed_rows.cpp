// SPDX-License-Identifier: BSD-3-Clause
// Closed bodies and scans of such: are surface and mesh closed?
#include "borders/closed_rows.h"

#include <cmath>
#include <cstdio>
#include <map>

#include "borders/closed_bodies.h"
#include "borders/lists.h"
#include "borders/mesh_shape.h"
#include "pcl_slim/core/vector3.h"
#include "scan/cloud_file.h"

namespace pcl_slim::borders {
namespace {

constexpr std::size_t kPoints = 20000;  ///< of a body
constexpr int kSeeds = 3;

/** \brief Mean spacing of a body's random points as a share of the diagonal: twice the mean distance
 * from a point to the next. */
double spacingOf(measure::Body body, std::size_t count) {
  const measure::Scene scene = measure::makeBody(body, measure::Spread::kRandom, count, 0.0, 1);
  std::vector<Vector3> points;
  for (std::size_t i = 0; i + 2 < scene.points.size(); i += 3) {
    points.push_back({scene.points[i], scene.points[i + 1], scene.points[i + 2]});
  }
  const rivals::PointTree tree(points);
  double sum = 0.0;
  for (const Vector3& p : points) sum += length(subtract(points[tree.nearest(p, 2).back()], p));
  return 2.0 * sum / static_cast<double>(points.size()) / scene.diagonal;
}

class ClosedRows {
 public:
  explicit ClosedRows(const ClosedSettings& settings) : s_(settings) {}

  /** \brief The row's name has been printed. \param[in] group what it is summed up with */
  Error add(const CloudView& view, std::uint64_t seed, const std::string& group) {
    const Result<PointStore> store = PointStore::build(view, s_.fit.threads);
    if (!store) return store.error();
    FitParams params = s_.fit;
    params.seed = seed;
    SLIMSurface surface;
    FitStatistics fit;
    if (Error error = fitSurface(*store, params, surface, &fit)) return error;
    TriangleMesh mesh;
    MeshStatistics statistics;
    if (Error error = extractMesh(surface, s_.mesh, mesh, &statistics)) return error;
    const MeshCensus& c = statistics.census;
    const std::size_t flat = countFlatTriangles(mesh);
    const bool closed = c.border_edges == 0, open_leaves = fit.open_leaves > 0;
    const bool good = closed && !open_leaves && c.components == 1 && flat == 0;
    std::printf(
        " %llu | %llu | %llu | %llu | %llu | %llu | %zu | %zu | %s |\n",
        static_cast<unsigned long long>(fit.points), static_cast<unsigned long long>(fit.leaves),
        static_cast<unsigned long long>(fit.open_leaves),
        static_cast<unsigned long long>(c.triangles), static_cast<unsigned long long>(c.components),
        static_cast<unsigned long long>(c.border_edges), countLoops(mesh), flat, good ? "ok" : "-");
    std::fflush(stdout);
    std::vector<std::string> names(1, "all");
    if (group != names[0]) names.push_back(group);
    for (const std::string& name : names) {
      Sum& sum = groups_[name];
      ++sum.rows;
      sum.good += good ? 1 : 0;
      sum.whole += open_leaves ? 0 : 1;
      sum.closed += closed ? 1 : 0;
      sum.one += c.components == 1 ? 1 : 0;
      sum.sound += flat == 0 ? 1 : 0;
    }
    return {};
  }

  static void printHead() {
    std::printf(
        "| body | points | leaves | open | triangles | components | border edges | loops | zero "
        "area | |\n|---|---|---|---|---|---|---|---|---|---|\n");
  }

  /** \brief As rows of a table of markdown. */
  void printSummary() const {
    std::printf(
        "\n| rows | number | good | without open leaf | without border edge | of one component | "
        "without triangle of zero area |\n|---|---|---|---|---|---|---|\n");
    for (const auto& [name, sum] : groups_) {
      std::printf("| %s | %zu | %zu | %zu | %zu | %zu | %zu |\n", name.c_str(), sum.rows, sum.good,
                  sum.whole, sum.closed, sum.one, sum.sound);
    }
  }

 private:
  struct Sum {
    std::size_t rows = 0, good = 0, whole = 0, closed = 0, one = 0, sound = 0;
  };

  const ClosedSettings& s_;
  std::map<std::string, Sum> groups_;
};

Error addBodies(const ClosedSettings& s, ClosedRows& rows) {
  for (const std::string& body_name : wordsOf(s.bodies)) {
    measure::Body body;
    if (!measure::parseBody(body_name, body)) {
      return {ErrorCode::kBadArgument, "no body is called '" + body_name +
                                           "'; take sphere, torus, bumpy, ellipsoid or amphora"};
    }
    const double spacing = spacingOf(body, kPoints);
    for (const std::string& spread_name : wordsOf(s.spreads)) {
      measure::Spread spread;
      if (!measure::parseSpread(spread_name, spread)) {
        return {ErrorCode::kBadArgument,
                "no spread is called '" + spread_name + "'; take random, blue, uneven or step"};
      }
      for (const double noise : s.noise) {
        char level[32];
        std::snprintf(level, sizeof level, ", noise %g", noise);
        const std::string group = spread_name + level;
        for (int seed = 1; seed <= kSeeds; ++seed) {
          const auto number = static_cast<std::uint64_t>(seed);
          const measure::Scene scene =
              measure::makeBody(body, spread, kPoints, noise * spacing, number);
          std::printf("| %s, %s, noise %g, seed %d |", body_name.c_str(), spread_name.c_str(),
                      noise, seed);
          if (Error error = rows.add(measure::viewOf(scene, nullptr, false), number, group))
            return error;
        }
      }
    }
  }
  return {};
}

Error addFiles(const ClosedSettings& s, ClosedRows& rows) {
  for (const std::string& file : wordsOf(s.files)) {
    const Result<CloudFile> cloud = loadCloudFile(file);
    if (!cloud) return cloud.error();
    std::printf("| %s |", file.substr(file.find_last_of('/') + 1).c_str());
    if (Error error = rows.add(cloud->view(s.use_normals), s.fit.seed, "all")) return error;
  }
  return {};
}

}  // namespace

Error printClosedRows(const ClosedSettings& settings) {
  ClosedRows rows(settings);
  ClosedRows::printHead();
  const Error error = settings.files.empty() ? addBodies(settings, rows) : addFiles(settings, rows);
  if (!error) rows.printSummary();
  return error;
}

}  // namespace pcl_slim::borders

// SPDX-License-Identifier: BSD-3-Clause
// CGAL's ridges of a mesh beside ours of its points: Monge_via_jet_fitting and Ridge_approximation.
// The mesh joins the points as they were before noise moved them, which no scan offers: the convex
// hull of their directions from the origin, which stars such as these surfaces allow.
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Ridges.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cstdio>
#include <map>

#include "common/options.h"
#include "line_run.h"
#include "pcl_slim/cloud/knn.h"
#include "support/lab/bench.h"
#include "support/lab/line_truth.h"

namespace {

using namespace pcl_slim;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Mesh::Vertex_index;
using Numbers = Mesh::Property_map<Vertex, double>;
using Vectors = Mesh::Property_map<Vertex, Kernel::Vector_3>;
using Ridges = CGAL::Ridge_approximation<Mesh, Numbers, Vectors>;
using Segments = std::vector<std::vector<measure::Segment>>;  ///< ridges, ravines

constexpr std::size_t kJetDegree = 4;

struct Settings {
  std::string surface = "ellipsoid";
  int points = 100000, neighbors = 20, seed = 7, cells = 1500;
  double noise = 0, normal_noise = 0.05;
};

/** A curve that CGAL found. */
struct Curve {
  std::size_t kind;  ///< 0: ridge, 1: ravine
  double strength;
  std::vector<measure::Segment> segments;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("cgal_lines_bench", "1", "Measures CGAL's ridges of a mesh beside ours.");
  options.text("surface", &s.surface, "NAME", "ellipsoid, bumpy or box");
  options.integer("points", &s.points, 100, 10000000, "size of the cloud");
  options.number("noise", &s.noise, 0, 1, "noise, as a share of the box diagonal");
  options.integer("neighbors", &s.neighbors, 15, 10000,
                  "points that each of CGAL's jets is fitted to");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the scene");
  options.integer("cells", &s.cells, 50, 10000, "cells a side of the grid that finds exact lines");
  return options;
}

/** The mesh of some points, joined as their clean places are. */
Mesh meshOf(const measure::Scene& clean, const measure::Scene& scene) {
  using Hull = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Hull::Point_3> hull;
  std::vector<Hull::Point_3> directions;
  std::map<Hull::Point_3, std::uint32_t> number;
  Mesh mesh;
  for (std::size_t i = 0; i < clean.points.size() / 3; ++i) {
    const double *p = &clean.points[3 * i], *q = &scene.points[3 * i];
    const Vector3 d = normalized({p[0], p[1], p[2]});
    directions.emplace_back(d[0], d[1], d[2]);
    number.emplace(directions.back(), static_cast<std::uint32_t>(i));
    mesh.add_vertex({q[0], q[1], q[2]});
  }
  CGAL::convex_hull_3(directions.begin(), directions.end(), hull);
  for (const auto face : hull.faces()) {
    std::vector<Vertex> corners;
    for (const auto v : hull.vertices_around_face(hull.halfedge(face))) {
      corners.emplace_back(number.at(hull.point(v)));
    }
    mesh.add_face(corners);
  }
  return mesh;
}

/** What CGAL's ridges are computed from, at each vertex. */
struct Jets {
  Numbers k1, k2, b0, b3, p1, p2;
  Vectors d1, d2;

  explicit Jets(Mesh& mesh) {
    for (auto* column : {&k1, &k2, &b0, &b3, &p1, &p2}) {
      *column = mesh.add_property_map<Vertex, double>().first;
    }
    d1 = mesh.add_property_map<Vertex, Kernel::Vector_3>().first;
    d2 = mesh.add_property_map<Vertex, Kernel::Vector_3>().first;
  }

  void fit(Vertex v, const std::vector<Kernel::Point_3>& points, const Kernel::Vector_3& inwards) {
    using Fitting = CGAL::Monge_via_jet_fitting<Kernel>;
    Fitting fitting;
    Fitting::Monge_form form = fitting(points.begin(), points.end(), kJetDegree, kJetDegree);
    form.comply_wrt_given_normal(inwards);
    const double a = form.principal_curvatures(0), b = form.principal_curvatures(1);
    const auto third = [&](std::size_t i) { return form.third_order_coefficients(i); };
    k1[v] = a;
    k2[v] = b;
    d1[v] = form.maximal_principal_direction();
    d2[v] = form.minimal_principal_direction();
    b0[v] = third(0);
    b3[v] = third(3);
    p1[v] = 3 * third(1) * third(1) + (a - b) * (form.fourth_order_coefficients(0) - 3 * a * a * a);
    p2[v] = 3 * third(2) * third(2) + (b - a) * (form.fourth_order_coefficients(4) - 3 * b * b * b);
  }
};

/** Jets at all vertices, each from its nearest neighbours. */
Error fitJets(const Settings& s, const measure::Scene& scene, const Mesh& mesh, Jets& jets) {
  const auto store = PointStore::build(measure::viewOf(scene, nullptr, true), 1);
  if (!store) return store.error();
  NeighborSearch search(*store);
  std::vector<std::uint32_t> near;
  std::vector<float> distances_sq;
  std::vector<Kernel::Point_3> points;
  const auto count = static_cast<std::size_t>(s.neighbors);
  for (std::size_t i = 0; i < store->size(); ++i) {
    search.nearest(i, count, near, distances_sq);
    points.clear();
    for (const std::uint32_t j : near)
      points.push_back(mesh.point(Vertex(store->orderOfStore()[j])));
    const std::uint32_t vertex = store->orderOfStore()[i];
    const float* n = &scene.normals[3 * static_cast<std::size_t>(vertex)];
    jets.fit(Vertex(vertex), points, {-n[0], -n[1], -n[2]});
  }
  return {};
}

std::vector<Curve> curvesOf(const Mesh& mesh, const Jets& jets) {
  std::vector<Ridges::Ridge_line*> found;
  Ridges ridges(mesh, jets.k1, jets.k2, jets.b0, jets.b3, jets.d1, jets.d2, jets.p1, jets.p2);
  ridges.compute_crest_ridges(std::back_inserter(found), CGAL::Ridge_order_4);
  std::vector<Curve> curves;
  for (const Ridges::Ridge_line* line : found) {
    Curve curve{line->line_type() == CGAL::MAX_CREST_RIDGE ? 0u : 1u, line->strength(), {}};
    std::vector<Vector3> places;
    for (const auto& [edge, share] : *line->line()) {
      const auto p =
          CGAL::barycenter(mesh.point(mesh.source(edge)), share, mesh.point(mesh.target(edge)));
      places.push_back({p.x(), p.y(), p.z()});
    }
    for (std::size_t i = 1; i < places.size(); ++i) {
      curve.segments.push_back({places[i - 1], places[i]});
    }
    curves.push_back(std::move(curve));
    delete line;
  }
  return curves;
}

void printRow(const char* who, const measure::LineScore& score, std::size_t pieces,
              double microseconds) {
  std::printf("| %s | %.3f | %.3f | %.3f | %.3f | %.3f | %.1f | %zu | %.1f |\n", who, score.rms,
              score.found1, score.found3, score.off1, score.off3, score.found_length, pieces,
              microseconds);
  std::fflush(stdout);
}

/** CGAL's curves from a strength on. */
measure::LineScore scoreAbove(const std::vector<Curve>& curves, double least, const Segments& truth,
                              double spacing, std::size_t& pieces) {
  Segments found(2);
  pieces = 0;
  for (const Curve& curve : curves) {
    if (!(curve.strength >= least)) continue;
    ++pieces;
    auto& all = found[curve.kind];
    all.insert(all.end(), curve.segments.begin(), curve.segments.end());
  }
  return measure::scoreLines(found, truth, spacing);
}

Error runCgal(const Settings& s, const measure::Scene& clean, const measure::Scene& scene,
              const Segments& truth, double spacing) {
  Mesh mesh = meshOf(clean, scene);
  const double begin = measure::cpuSeconds();
  Jets jets(mesh);
  if (Error error = fitJets(s, scene, mesh, jets)) return error;
  const std::vector<Curve> curves = curvesOf(mesh, jets);
  const double microseconds = 1e6 * (measure::cpuSeconds() - begin) / s.points;
  std::size_t pieces = 0, best_pieces = 0;
  const auto all = scoreAbove(curves, 0, truth, spacing, pieces);
  printRow("CGAL, all lines", all, pieces, microseconds);
  measure::LineScore best = all;
  best_pieces = pieces;
  for (double least = 0.01; least < 20; least *= 1.25) {
    const auto score = scoreAbove(curves, least, truth, spacing, pieces);
    if (pieces == 0) break;
    if (score.found3 - score.off3 <= best.found3 - best.off3) continue;
    best = score;
    best_pieces = pieces;
  }
  printRow("CGAL, best strength", best, best_pieces, microseconds);
  return {};
}

Error runOurs(const measure::Scene& scene, const Segments& truth, double spacing) {
  CrestParams params;
  params.threads = 1;
  lines_bench::LineRun run;
  if (Error error = runLines(measure::viewOf(scene, nullptr, true), {}, params, run)) return error;
  const auto score = measure::scoreLines(lines_bench::segmentsOf(run.lines), truth, spacing);
  printRow("SLIM", score, run.lines.numLines(), run.fit + run.project + run.trace);
  return {};
}

Error printTable(const Settings& s) {
  measure::LineSurface surface;
  if (!measure::parseLineSurface(s.surface, surface) || s.surface == "wtorus" ||
      s.surface == "torus")
    return {ErrorCode::kBadArgument, "the surface must be ellipsoid, bumpy or box"};
  const auto count = static_cast<std::size_t>(s.points);
  const auto seed = static_cast<std::uint64_t>(s.seed);
  const auto clean = measure::sampleSurface(surface, count, 0, s.normal_noise, seed);
  const auto scene = measure::sampleSurface(surface, count, s.noise, s.normal_noise, seed);
  Segments truth;
  for (const bool ravine : {false, true})
    truth.push_back(measure::exactLines(surface, ravine, static_cast<std::size_t>(s.cells)));
  const double spacing = std::sqrt(measure::areaOf(surface) / s.points);
  std::printf("%s, %d points, noise %g, jets of %d neighbours\n\n", s.surface.c_str(), s.points,
              s.noise, s.neighbors);
  std::printf(
      "| | RMS | found1 | found3 | off1 | off3 | length | pieces | us |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  if (Error error = runOurs(scene, truth, spacing)) return error;
  return runCgal(s, clean, scene, truth, spacing);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  if (const Error error = printTable(s)) {
    std::fprintf(stderr, "cgal_lines_bench: %s\n", error.message.c_str());
    return 2;
  }
  return 0;
}

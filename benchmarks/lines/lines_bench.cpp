// SPDX-License-Identifier: BSD-3-Clause
// Crest lines against exact ones: how many are found, how many are false, how far off they are.
#include <cmath>
#include <cstdio>
#include <map>
#include <new>

#include "common/options.h"
#include "line_run.h"
#include "pcl_slim/features/crest_lines.h"
#include "support/lab/bench.h"
#include "support/lab/line_truth.h"

namespace {

using namespace pcl_slim;
using measure::Segment;

struct Settings {
  std::string surface = "ellipsoid,bumpy,box,wtorus", noise = "0,0.0001,0.001,0.005";
  std::string points = "100000", vectors = "best";
  double normal_noise = 0.05;
  double lambda = 0;
  int degree = 0, seed = 7, seeds = 1, cells = 1500;
  FitParams fit;
  bool normals = true, turned = false, unfiltered = false;
  CrestParams params;
  std::vector<double> noise_list, point_list;
};

/** What one run of a scene gave. */
struct Outcome {
  measure::LineScore score;
  std::size_t lines = 0;
  double radius = 0, off_radius = 0;  ///< see printTable()
  double z = 0, highest = 0;  ///< RMS of the vertices' significance, greatest mean of a line
  double fit = 0, project = 0, trace = 0;  ///< us a point
};

struct Truth {
  measure::LineSurface surface;
  double area = 0;
  std::vector<std::vector<Segment>> lines;  ///< ridges, ravines
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("lines_bench", "1", "Measures crest lines against exact ones.");
  options.text("surface", &s.surface, "NAME,...",
               "ellipsoid, bumpy, mix, box, wtorus, sphere, torus");
  options.text("points", &s.points, "N,...", "sizes of the cloud");
  options.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  options.text("noise", &s.noise, "S,...", "noise, as a share of the box diagonal");
  options.number("normal_noise", &s.normal_noise, 0, 3, "error of the normals given, radians");
  options.toggle("normals", &s.normals, "give normals");
  options.integer("seed", &s.seed, 0, 1000000, "first seed of the scenes");
  options.integer("seeds", &s.seeds, 1, 1000, "scenes a row; figures are means");
  options.integer("degree", &s.degree, 1, 4, "degree of the polynomials");
  options.number("lambda", &s.lambda, 0, 1,
                 "noise variance to fit for, as a share of the squared diagonal; 0: estimated");
  options.integer("cells", &s.cells, 50, 10000, "cells a side of the grid that finds exact lines");
  options.number("step", &s.params.step, 0.02, 0.5, "step along lines, in radii");
  options.number("strength", &s.params.min_strength, 0, 1e6, "least strength of a line");
  options.toggle("turned", &s.turned,
                 "turn the points by 33 degrees; lines against those unturned");
  options.toggle("unfiltered", &s.unfiltered, "keep every line, whatever its significance");
  options.integer("threads", &s.params.threads, 0, 4096, "threads, 0: all cores");
  return options;
}

/** Turns a vector by 33 degrees about an axis askew, or back. */
template <typename T>
void turn(T* p, double sign) {
  const Vector3 axis = normalized({0.36, 0.48, 0.8});
  const double angle = sign * 33 * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
  const Vector3 v = {p[0], p[1], p[2]}, x = cross(axis, v);
  const double d = dot(axis, v);
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = static_cast<T>(c * v[a] + s * x[a] + (1 - c) * d * axis[a]);
  }
}

Error trace(const Settings& s, const measure::Scene& scene, CrestLines& lines, Outcome& outcome) {
  CrestParams params = s.params;
  if (s.unfiltered) params.significance = params.peak_significance = params.min_length = 0;
  lines_bench::LineRun run;
  const CloudView cloud = measure::viewOf(scene, nullptr, s.normals);
  if (Error error = runLines(cloud, s.fit, params, run)) return error;
  lines = std::move(run.lines);
  outcome.fit = run.fit;
  outcome.project = run.project;
  outcome.trace = run.trace;
  outcome.lines = lines.numLines();
  for (const float z : lines.significance) {
    outcome.z += z * z / static_cast<double>(lines.numVertices());
  }
  outcome.z = std::sqrt(outcome.z);
  for (const double z : lines.mean_significance) outcome.highest = std::max(outcome.highest, z);
  return {};
}

/** Lines of turned points, turned back, against those of the points as they are. */
Error traceTurned(const Settings& s, measure::Scene scene, CrestLines& lines, Outcome& outcome) {
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    turn(&scene.points[i], 1);
    turn(&scene.normals[i], 1);
  }
  if (Error error = trace(s, scene, lines, outcome)) return error;
  for (auto& p : lines.position) turn(p.data(), -1);
  return {};
}

/** Mean radius of the leaves along the lines, in spacings, and the share of vertices that are
 * farther than a quarter of theirs from the truth. */
void compareRadii(const CrestLines& lines, const std::vector<std::vector<Segment>>& truth,
                  double spacing, Outcome& outcome) {
  const auto n = static_cast<double>(std::max<std::size_t>(1, lines.numVertices()));
  double most = spacing;
  for (const float r : lines.radius) most = std::max<double>(most, r);
  for (std::size_t type = 0; type < truth.size(); ++type) {
    const measure::SegmentIndex index(truth[type], 0.26 * most);
    for (std::size_t i = 0; i < lines.numLines(); ++i) {
      if (static_cast<std::size_t>(lines.type[i]) != type) continue;
      for (std::uint32_t v = lines.line_begin[i]; v < lines.line_begin[i + 1]; ++v) {
        const double r = lines.radius[v];
        outcome.radius += r / spacing / n;
        if (index.distance(lines.position[v]) > 0.25 * r) outcome.off_radius += 1 / n;
      }
    }
  }
}

Error runScene(const Settings& s, const Truth& truth, std::size_t points, double noise, int seed,
               Outcome& outcome) {
  const auto scene = measure::sampleSurface(truth.surface, points, noise, s.normal_noise,
                                            static_cast<std::uint64_t>(seed));
  CrestLines lines;
  if (Error error = trace(s, scene, lines, outcome)) return error;
  const double spacing = std::sqrt(truth.area / static_cast<double>(points));
  auto reference = truth.lines;
  if (s.turned) {
    reference = lines_bench::segmentsOf(lines);
    if (Error error = traceTurned(s, scene, lines, outcome)) return error;
  }
  outcome.score = measure::scoreLines(lines_bench::segmentsOf(lines), reference, spacing);
  compareRadii(lines, reference, spacing, outcome);
  return {};
}

Error printRow(const Settings& s, const std::string& name, const Truth& truth, std::size_t points,
               double noise) {
  Outcome sum;
  for (int i = 0; i < s.seeds; ++i) {
    Outcome one;
    if (Error error = runScene(s, truth, points, noise, s.seed + i, one)) return error;
    const double share = 1.0 / s.seeds;
    using Column = double measure::LineScore::*;
    using Score = measure::LineScore;
    for (const Column c : {&Score::found_length, &Score::true_length, &Score::rms, &Score::found1,
                           &Score::found3, &Score::off1, &Score::off3}) {
      sum.score.*c += share * (one.score.*c);
    }
    sum.lines += one.lines;
    sum.radius += share * one.radius;
    sum.off_radius += share * one.off_radius;
    sum.z += share * one.z;
    sum.highest = std::max(sum.highest, one.highest);
    sum.fit += share * one.fit;
    sum.project += share * one.project;
    sum.trace += share * one.trace;
  }
  const measure::LineScore& r = sum.score;
  std::printf(
      "| %s | %zu | %g | %.3f | %.3f | %.3f | %.3f | %.3f | %.1f | %.3f | %.2f | %.2f | %zu | %.1f "
      "| %.1f | %.1f "
      "| %.2f | %.2f |\n",
      name.c_str(), points, noise, r.rms, r.found1, r.found3, r.off1, r.off3, sum.radius,
      sum.off_radius, r.found_length, r.true_length, sum.lines / static_cast<std::size_t>(s.seeds),
      sum.z, sum.highest, sum.fit, sum.project, sum.trace);
  std::fflush(stdout);
  return {};
}

Error printTable(Settings& s) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at <= s.surface.size();) {
    const std::size_t comma = std::min(s.surface.find(',', at), s.surface.size());
    names.push_back(s.surface.substr(at, comma - at));
    at = comma + 1;
  }
  if (Error error = measure::parseLists({{"points", &s.points, 100, 4e9, true, &s.point_list},
                                         {"noise", &s.noise, 0, 1, false, &s.noise_list}})) {
    return error;
  }
  std::printf(
      "| surface | points | noise | RMS | found1 | found3 | off1 | off3 | radius | off r/4 | found "
      "| true | "
      "lines | z | highest | fit us | projection us | lines us |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    Truth truth;
    if (!measure::parseLineSurface(name, truth.surface)) {
      return {ErrorCode::kBadArgument, "there is no surface '" + name + "'; see -h"};
    }
    truth.area = measure::areaOf(truth.surface);
    // Spheres and tori have no lines: what differences of rounding show there is none.
    const bool none = name == "sphere" || name == "torus";
    for (const bool ravine : {false, true}) {
      truth.lines.emplace_back();
      if (none) continue;
      truth.lines.back() =
          measure::exactLines(truth.surface, ravine, static_cast<std::size_t>(s.cells));
    }
    for (const double points : s.point_list) {
      for (const double noise : s.noise_list) {
        Error error = printRow(s, name, truth, static_cast<std::size_t>(points), noise);
        if (error) return error;
      }
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  s.params.threads = 1;
  s.fit.trim = false;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  s.fit.degree = unlessZero(s.degree);
  s.fit.lambda = unlessZero(s.lambda);
  Error error = measure::chooseVectors(s.vectors);
  if (!error) error = printTable(s);
  if (error) {
    std::fprintf(stderr, "lines_bench: %s\n", error.message.c_str());
    return 2;
  }
  return 0;
}

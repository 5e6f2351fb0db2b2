// SPDX-License-Identifier: BSD-3-Clause
// Fit time in units, by stage, with memory: without options the whole sweep. One unit is a
// nanoflann build plus one 10-neighbour pass with eigenvalues on the same points, measured beside
// each fit, so that figures compare across machines.
#include <cstdio>
#include <random>

#include "common/run_program.h"
#include "fit/nanoflann_unit.h"
#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/fit/fit.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

/** Error of the normals handed to a fit, in radians. */
constexpr double kNormalNoise = 0.05;

struct Settings {
  std::string points = "100000,438000,1000000,5000000", degree = "1,2,3,4", threads = "1,2";
  std::string normals = "1,0", t_mdl = "0.01,0", noise = "0", shape = "bumpy", vectors = "best";
  int repeats = 3, clump = 0;
  /** Beyond this many points the sweep keeps two settings only; asking for one lifts it. */
  double sweep_limit = 2e6;

  std::vector<double> point_list, degree_list, thread_list, normal_list, t_mdl_list, noise_list;
  std::vector<std::string> shape_list;
};

struct Row {
  std::string shape;
  double noise = 0, t_mdl = 0;
  std::size_t points = 0;
  int degree = 2, threads = 1;
  bool normals = true;
};

/** Medians over the repeats; seconds unless said otherwise. */
struct Timing {
  std::vector<double> unit, units_cpu, units_wall, cpu, store, noise, cover, links, orient, trim;
  double counted_bytes = 0, peak_bytes = 0;
  FitStatistics fit;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("fit_bench", "1", "Times the fit in units of a nanoflann pass, by stage.");
  options.text("points", &s.points, "N,...", "sizes of the cloud");
  options.text("degree", &s.degree, "D,...", "degrees of the polynomials, 1 to 4");
  options.text("threads", &s.threads, "N,...", "numbers of threads");
  options.text("normals", &s.normals, "0|1,...", "1: normals given, 0: none");
  options.text("t_mdl", &s.t_mdl, "T,...", "the paper's T_MDL; 0: the default penalty");
  options.text("noise", &s.noise, "S,...", "noise, as a share of the box diagonal");
  options.text("shape", &s.shape, "NAME,...", "sphere, torus, bumpy, relief");
  options.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  options.integer("clump", &s.clump, 0, 100000000,
                  "points more about the first one, scattered by half the noise");
  options.integer("repeats", &s.repeats, 1, 100, "runs of each row; medians are shown");
  return options;
}

Error finishOptions(const OptionTable& options, Settings& s) {
  if (options.given("degree") || options.given("t_mdl")) s.sweep_limit = 1e18;
  if (Error error = measure::chooseVectors(s.vectors)) return error;
  if (Error error = measure::parseShapes(s.shape, s.shape_list)) return error;
  return measure::parseLists({{"points", &s.points, 100, 4e9, true, &s.point_list},
                              {"degree", &s.degree, 1, 4, true, &s.degree_list},
                              {"threads", &s.threads, 1, 4096, true, &s.thread_list},
                              {"normals", &s.normals, 0, 1, true, &s.normal_list},
                              {"t_mdl", &s.t_mdl, 0, 1e3, false, &s.t_mdl_list},
                              {"noise", &s.noise, 0, 1, false, &s.noise_list}});
}

/** The largest clouds show two settings: the one peers are compared at and the default. */
bool inSweep(const Settings& s, const Row& row) {
  if (static_cast<double>(row.points) <= s.sweep_limit) return true;
  return row.t_mdl > 0 ? row.degree == 2 : row.degree == 4;
}

Error fitOnce(const CloudView& view, const FitParams& params, Timing& t) {
  const measure::MemoryGauge memory;
  const double cpu = measure::cpuSeconds(), wall = measure::wallSeconds();
  const auto store = PointStore::build(view, params.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  if (Error error = fitSurface(*store, params, surface, &t.fit)) return error;
  const double cpu_used = measure::cpuSeconds() - cpu, wall_used = measure::wallSeconds() - wall;
  t.peak_bytes = memory.peakBytes();
  t.counted_bytes = static_cast<double>(store->memoryBytes() + t.fit.working_bytes);
  t.units_cpu.push_back(cpu_used / t.unit.back());
  t.units_wall.push_back(wall_used / t.unit.back());
  t.cpu.push_back(cpu_used);
  t.store.push_back(store->statistics().seconds);
  t.noise.push_back(t.fit.seconds.noise);
  t.cover.push_back(t.fit.seconds.cover);
  t.links.push_back(t.fit.seconds.links);
  t.orient.push_back(t.fit.seconds.orient);
  t.trim.push_back(t.fit.seconds.trim);
  return {};
}

void printHeader() {
  std::printf("instruction set %s\n\n", kernels::instructionSet());
  std::puts(
      "| cloud | noise | T | degree | normals | threads | **units CPU** | **units wall** "
      "| µs/pt CPU | store + noise + cover + links + orient + trim | unit, µs/pt | leaves/pt "
      "| bytes/pt counted | bytes/pt peak |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
}

void printRow(const Row& row, const Timing& t) {
  const double n = static_cast<double>(row.points), micro = 1e6 / n;
  const auto us = [micro](const std::vector<double>& seconds) {
    return micro * measure::median(seconds);
  };
  char penalty[32] = "default", peak[32] = "–";
  if (row.t_mdl > 0) std::snprintf(penalty, sizeof(penalty), "%g", row.t_mdl);
  if (t.peak_bytes >= 0) std::snprintf(peak, sizeof(peak), "%.0f", t.peak_bytes / n);
  std::printf(
      "| %s %zu | %g | %s | %d | %s | %d | %.3f | %.3f | %.3f "
      "| %.3f + %.3f + %.3f + %.3f + %.3f + %.3f | %.3f | %.4f | %.0f | %s |\n",
      row.shape.c_str(), row.points, row.noise, penalty, row.degree, row.normals ? "given" : "none",
      row.threads, measure::median(t.units_cpu), measure::median(t.units_wall), us(t.cpu),
      us(t.store), us(t.noise), us(t.cover), us(t.links), us(t.orient), us(t.trim), us(t.unit),
      static_cast<double>(t.fit.leaves) / n, t.counted_bytes / n, peak);
  std::fflush(stdout);
}

Error measureRow(const Row& row, int repeats, const measure::Scene& scene,
                 const std::vector<float>& xyz) {
  FitParams params;
  params.degree = row.degree;
  if (row.t_mdl > 0) params.size = MDLThreshold{row.t_mdl};
  params.threads = row.threads;
  Timing timing;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    timing.unit.push_back(measure::measureUnit(xyz));
    if (Error error = fitOnce(measure::viewOf(scene, &xyz, row.normals), params, timing)) {
      return error;
    }
  }
  printRow(row, timing);
  return {};
}

/** Adds the points of a sensor that stood still: about the first point, inside the noise. */
void addClump(int count, double noise, measure::Scene& scene) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss(0.0, 0.5 * noise * scene.diagonal);
  for (int i = 0; i < 3 * count; ++i) {
    const auto axis = static_cast<std::size_t>(i % 3);
    scene.points.push_back(scene.points[axis] + gauss(random));
    scene.normals.push_back(scene.normals[axis]);
  }
}

/** All rows of one cloud. */
Error measureCloud(const Settings& s, Row row) {
  measure::Shape shape;
  measure::parseShape(row.shape, shape);
  measure::Scene scene = measure::makeScene(shape, row.points, row.noise, kNormalNoise, 7);
  addClump(s.clump, row.noise, scene);
  row.points += static_cast<std::size_t>(s.clump);
  const std::vector<float> xyz(scene.points.begin(), scene.points.end());
  for (double t_mdl : s.t_mdl_list) {
    for (double degree : s.degree_list) {
      for (double normals : s.normal_list) {
        for (double threads : s.thread_list) {
          row.t_mdl = t_mdl;
          row.degree = static_cast<int>(degree);
          row.normals = normals != 0;
          row.threads = static_cast<int>(threads);
          if (!inSweep(s, row)) continue;
          if (Error error = measureRow(row, s.repeats, scene, xyz)) return error;
        }
      }
    }
  }
  return {};
}

Exit run(const OptionTable& options, Settings& s) {
  if (Error error = finishOptions(options, s)) return Exit::usage(error);
  printHeader();
  Row row;
  for (const std::string& shape : s.shape_list) {
    for (double noise : s.noise_list) {
      for (double points : s.point_list) {
        row.shape = shape;
        row.noise = noise;
        row.points = static_cast<std::size_t>(points);
        if (Error error = measureCloud(s, row)) return error;
      }
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give smaller -points", [&] { return run(options, s); });
}

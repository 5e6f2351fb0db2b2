// SPDX-License-Identifier: BSD-3-Clause
// Error of fit and projection against exact surfaces: position, normal and mean curvature.
#include <cmath>
#include <cstdio>
#include <functional>

#include "common/run_program.h"
#include "fit/accuracy.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;

struct Settings {
  std::string shape = "sphere,torus,bumpy,relief", noise = "0,0.0001,0.001,0.005";
  std::string degree = "4", normals = "0,1", t_mdl = "0", points = "100000", vectors = "best";
  double penalty = 0, lambda = 0, alpha = 0;
  double normal_noise = 0.05;
  int threads = 0, seed = 7;
  bool float_input = false, paper = false, by_degree = false, convergence = false,
       normals_as_data = false;

  std::vector<double> point_list, degree_list, normal_list, t_mdl_list, noise_list;
  std::vector<std::string> shape_list;
};

/** What names a row: one scene, fitted one way. */
struct Row {
  std::string name;
  measure::Shape shape = measure::Shape::kSphere;
  double noise = 0, t_mdl = 0;
  bool normals = true;
  const measure::Scene* scene = nullptr;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("accuracy_bench", "1", "Measures fits against exact surfaces.");
  options.text("shape", &s.shape, "NAME,...", "sphere, torus, bumpy, relief");
  options.text("points", &s.points, "N,...", "sizes of the cloud");
  options.text("noise", &s.noise, "S,...", "noise, as a share of the box diagonal");
  options.text("degree", &s.degree, "D,...", "degrees of the polynomials, 1 to 4");
  options.text("normals", &s.normals, "0|1,...", "1: normals given, 0: none");
  options.text("t_mdl", &s.t_mdl, "T,...", "the paper's T_MDL; 0: the penalty");
  options.number("penalty", &s.penalty, 1e-6, 1e6, "weight of the price of a coefficient");
  options.number("lambda", &s.lambda, 0, 1, "noise variance / squared diagonal", "estimated");
  options.number("alpha", &s.alpha, 0, 1, "cover radius, as a share of a leaf's radius",
                 "by the leaf");
  options.number("normal_noise", &s.normal_noise, 0, 3, "error of the normals given, radians");
  options.toggle("normals_as_data", &s.normals_as_data,
                 "fit positions and the normals given together");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the scenes");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  options.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  options.toggle("float", &s.float_input, "round coordinates to float first");
  options.toggle("paper", &s.paper, "the choices of Ohtake, Belyaev, Alexa 2005 throughout");
  options.toggle("by_degree", &s.by_degree, "short table: one column a degree");
  options.toggle("convergence", &s.convergence,
                 "noise-free errors against the point spacing, with slopes");
  return options;
}

Error finishOptions(const OptionTable& options, Settings& s) {
  if (s.convergence) {
    if (!options.given("shape")) s.shape = "bumpy,torus";
    if (!options.given("points")) s.points = "12500,50000,200000";
    if (!options.given("degree")) s.degree = "1,2,3,4";
    if (!options.given("normals")) s.normals = "1";
    if (!options.given("noise")) s.noise = "0";
  }
  if (Error error = measure::chooseVectors(s.vectors)) return error;
  if (Error error = measure::parseShapes(s.shape, s.shape_list)) return error;
  return measure::parseLists({{"points", &s.points, 100, 4e9, true, &s.point_list},
                              {"degree", &s.degree, 1, 4, true, &s.degree_list},
                              {"normals", &s.normals, 0, 1, true, &s.normal_list},
                              {"t_mdl", &s.t_mdl, 0, 1e3, false, &s.t_mdl_list},
                              {"noise", &s.noise, 0, 1, false, &s.noise_list}});
}

Result<measure::Outcome> measure(const Settings& s, const Row& row, int degree) {
  FitParams params;
  params.trim = false;
  params.degree = degree;
  params.size = PenaltyWeight{unlessZero(s.penalty)};
  if (row.t_mdl > 0) params.size = MDLThreshold{row.t_mdl};
  params.lambda = unlessZero(s.lambda);
  params.threads = s.threads;
  params.cover_radius = unlessZero(s.alpha);
  params.paper_mode = s.paper;
  params.normals_as_data = row.normals && s.normals_as_data;
  return measure::measureAccuracy(row.shape, *row.scene, params, row.normals, s.float_input);
}

/** T or "default". */
std::string penaltyName(double t_mdl) {
  char text[32] = "default";
  if (t_mdl > 0) std::snprintf(text, sizeof(text), "%g", t_mdl);
  return text;
}

/** Everything about one fit a row. */
Error printDetails(const Settings& s, const Row& row) {
  for (double degree : s.degree_list) {
    const auto outcome = measure(s, row, static_cast<int>(degree));
    if (!outcome) return outcome.error();
    const measure::Accuracy& e = outcome->accuracy;
    const FitStatistics& fit = outcome->fit;
    std::printf(
        "| %s | %g | %s | %g | %s | %.2e | %.2e | %.3g | %.3g | %.2e | %.2e | %.3f "
        "| %.0f%% | %d-%d | %llu | %llu |\n",
        row.name.c_str(), row.noise, penaltyName(row.t_mdl).c_str(), degree,
        row.normals ? "given" : "none", e.position, e.position / row.scene->diagonal, e.normal,
        e.curvature, e.worst, outcome->sigma,
        static_cast<double>(fit.leaves) / static_cast<double>(fit.points),
        100.0 * static_cast<double>(fit.support_limited) / static_cast<double>(fit.leaves),
        fit.first_level, fit.last_level, static_cast<unsigned long long>(fit.uncovered),
        static_cast<unsigned long long>(outcome->unsupported));
    std::fflush(stdout);
  }
  return {};
}

/** One column a degree: position, normal, curvature. */
Error printByDegree(const Settings& s, const Row& row) {
  std::uint64_t unsupported = 0;
  std::printf("| %s | %g | %s | %s |", row.name.c_str(), row.noise, penaltyName(row.t_mdl).c_str(),
              row.normals ? "given" : "none");
  for (double degree : s.degree_list) {
    const auto outcome = measure(s, row, static_cast<int>(degree));
    if (!outcome) return outcome.error();
    const measure::Accuracy& e = outcome->accuracy;
    std::printf(" %.1e %.2g %.2g |", e.position, e.normal, e.curvature);
    unsupported = std::max(unsupported, outcome->unsupported);
  }
  std::printf(" %llu |\n", static_cast<unsigned long long>(unsupported));
  std::fflush(stdout);
  return {};
}

void printHeader(const Settings& s) {
  if (!s.by_degree) {
    std::puts(
        "| shape | noise | T | degree | normals | RMS position | of L | normal ° | H relative "
        "| worst | sqrt(lambda)/L | leaves/pt | support-limited | levels | uncovered | unsupported "
        "|\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    return;
  }
  std::fputs("| shape | noise | T | normals |", stdout);
  for (double degree : s.degree_list) std::printf(" degree %g: position, normal °, H |", degree);
  std::fputs(" unsupported |\n|---|---|---|---|---|", stdout);
  for (std::size_t i = 0; i < s.degree_list.size(); ++i) std::fputs("---|", stdout);
  std::puts("");
}

/** Calls work(row) for every shape under every noise. */
Error forEachShape(const Settings& s, const std::function<Error(const Row&)>& work) {
  Row row;
  for (const std::string& name : s.shape_list) {
    row.name = name;
    measure::parseShape(name, row.shape);
    for (double noise : s.noise_list) {
      row.noise = noise;
      if (Error error = work(row)) return error;
    }
  }
  return {};
}

/** Calls print(row) for one scene fitted every way asked for. */
template <typename Print>
Error forEachFit(const Settings& s, Row row, double points, const Print& print) {
  const auto count = static_cast<std::size_t>(points);
  const measure::Scene scene = measure::makeScene(row.shape, count, row.noise, s.normal_noise,
                                                  static_cast<std::uint64_t>(s.seed));
  row.scene = &scene;
  for (double t_mdl : s.t_mdl_list) {
    for (double normals : s.normal_list) {
      row.t_mdl = t_mdl;
      row.normals = normals != 0;
      if (Error error = print(row)) return error;
    }
  }
  return {};
}

Error printTable(const Settings& s) {
  printHeader(s);
  const auto print = [&s](const Row& row) {
    return s.by_degree ? printByDegree(s, row) : printDetails(s, row);
  };
  return forEachShape(s, [&](const Row& row) -> Error {
    for (double points : s.point_list) {
      if (Error error = forEachFit(s, row, points, print)) return error;
    }
    return {};
  });
}

/** "(3.02)": the power of the spacing, proportional to N^-1/2, that an error follows. */
std::string slope(double coarse, double fine, double coarse_points, double fine_points) {
  char text[32];
  const double power = std::log(coarse / fine) / (0.5 * std::log(fine_points / coarse_points));
  std::snprintf(text, sizeof(text), " (%.2f)", power);
  return text;
}

/** One shape, noise, penalty and degree: a row for each size of the cloud. */
Error printSlopes(const Settings& s, Row row, double normals, double t_mdl, double degree) {
  measure::Accuracy last;
  row.normals = normals != 0;
  row.t_mdl = t_mdl;
  for (std::size_t i = 0; i < s.point_list.size(); ++i) {
    const double n = s.point_list[i];
    const measure::Scene scene =
        measure::makeScene(row.shape, static_cast<std::size_t>(n), row.noise, s.normal_noise,
                           static_cast<std::uint64_t>(s.seed));
    row.scene = &scene;
    const auto outcome = measure(s, row, static_cast<int>(degree));
    if (!outcome) return outcome.error();
    const measure::Accuracy& e = outcome->accuracy;
    const auto since = [&](double coarse, double fine) {
      return i == 0 ? std::string() : slope(coarse, fine, s.point_list[i - 1], n);
    };
    std::printf(
        "| %s | %g | %s | %s | %g | %g | %.2e%s | %.2e%s | %.2e%s | %.3f |\n", row.name.c_str(),
        row.noise, penaltyName(t_mdl).c_str(), row.normals ? "given" : "none", degree, n,
        e.position, since(last.position, e.position).c_str(), e.normal,
        since(last.normal, e.normal).c_str(), e.curvature,
        since(last.curvature, e.curvature).c_str(), static_cast<double>(outcome->fit.leaves) / n);
    std::fflush(stdout);
    last = e;
  }
  return {};
}

Error printConvergence(const Settings& s) {
  std::puts(
      "| shape | noise | T | normals | degree | points | position (slope) "
      "| normal ° (slope) | H (slope) | leaves/pt |\n|---|---|---|---|---|---|---|---|---|---|");
  return forEachShape(s, [&](const Row& row) -> Error {
    for (double t_mdl : s.t_mdl_list) {
      for (double normals : s.normal_list) {
        for (double degree : s.degree_list) {
          if (Error error = printSlopes(s, row, normals, t_mdl, degree)) return error;
        }
      }
    }
    return {};
  });
}

Exit run(const OptionTable& options, Settings& s) {
  if (Error error = finishOptions(options, s)) return Exit::usage(error);
  return s.convergence ? printConvergence(s) : printTable(s);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give smaller -points", [&] { return run(options, s); });
}

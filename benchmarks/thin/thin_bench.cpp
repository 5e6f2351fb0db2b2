// SPDX-License-Identifier: BSD-3-Clause
// Thin parts: RMS distance to the exact surface of the default, beside a fit whose normals are
// exact, a fit without sides, and pcl::MovingLeastSquares and CGAL's jets at their best size with
// hindsight.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/run_program.h"
#include "fit/smoothed_points.h"
#include "rivals/jets.h"
#include "rivals/mls.h"
#include "support/lab/bench.h"
#include "thin/thin_cost.h"
#include "thin/thin_scenes.h"

namespace {

using namespace pcl_slim;
using thin::Scene;

struct Settings {
  std::string noise = "0,0.1,0.3", only, cost;
  int threads = 1, seed = 1;
  bool rivals = true;

  std::vector<double> noise_list, cost_list;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("thin_bench", "1", "Measures fits of thin parts against exact surfaces.");
  options.text("noise", &s.noise, "S,...", "RMS errors along each axis, in spacings");
  options.text("only", &s.only, "TEXT", "scenes whose name begins with it; all if empty");
  options.text("cost", &s.cost, "N,...", "measure time and memory at these numbers of points");
  options.toggle("rivals", &s.rivals, "run pcl::MovingLeastSquares and CGAL's jets");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the noise");
  options.integer("threads", &s.threads, 0, 4096, "threads of the fit, 0: all cores");
  return options;
}

Error finishOptions(Settings& s) {
  if (s.rivals && s.cost.empty()) {
    if (Error error = rivals::requireJets("-rivals 0")) return error;
  }
  if (!s.cost.empty()) {
    if (Error error = measure::parseLists({{"cost", &s.cost, 1000, 1e8, true, &s.cost_list}}))
      return error;
  }
  return measure::parseLists({{"noise", &s.noise, 0, 10, false, &s.noise_list}});
}

/** RMS distances to a scene's surface, of all points and of some; NAN of none. */
struct Errors {
  double all = 0, thick = 0, thin = 0;
};

/** \param[in] least thickness of a part that counts as thick */
Errors errorsOf(const Scene& scene, const std::vector<Vector3>& points, double least) {
  double sums[2] = {0, 0}, counts[2] = {0, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3& p = points[i];
    if (!std::isfinite(p[0] + p[1] + p[2])) continue;
    const int thick = scene.thickness(scene.points[i]) >= least * (1 - 1e-9);
    sums[thick] += std::pow(scene.distance(p), 2);
    ++counts[thick];
  }
  return {std::sqrt((sums[0] + sums[1]) / std::max(counts[0] + counts[1], 1.0)),
          std::sqrt(sums[1] / counts[1]), std::sqrt(sums[0] / counts[0])};
}

/** What a fit left of a scene's noise. */
struct Outcome {
  Errors rms;
  double sigma = 0, seconds = 0;
  FitStatistics fit;
};

Result<Outcome> fitOf(const Scene& scene, const CloudView& view, const FitParams& params,
                      double least) {
  const auto smoothed = measure::smoothPoints(view, params);
  if (!smoothed) return smoothed.error();
  return Outcome{errorsOf(scene, smoothed->points, least), smoothed->sigma, smoothed->seconds,
                 smoothed->fit};
}

/** The least errors over six sizes, each on its own. */
Errors bestRival(const Scene& scene, const std::vector<Vector3>& points, double least, bool jets) {
  Errors best{1e300, NAN, NAN};
  for (const double k : {12.0, 16.0, 24.0, 32.0, 64.0, 128.0}) {
    const auto moved = jets ? rivals::smoothByJets(points, static_cast<std::size_t>(k))
                            : rivals::smoothByMls(points, 2, std::sqrt(k / M_PI)).points;
    const Errors errors = errorsOf(scene, moved, least);
    best = {std::min(best.all, errors.all), std::fmin(best.thick, errors.thick),
            std::fmin(best.thin, errors.thin)};
  }
  return best;
}

void printOutcome(const Outcome& of) {
  std::printf(" %.4f (%llu) %.3f |", of.rms.all, static_cast<unsigned long long>(of.fit.leaves),
              of.sigma);
}

/** Prints a cell of the table: nothing for an error of no points. */
void printValue(double value) {
  if (std::isfinite(value)) {
    std::printf(" %.4f |", value);
  } else {
    std::printf(" - |");
  }
}

Error printRow(const Settings& s, const Scene& scene, double sigma) {
  const double least = std::max(1.0, 5 * sigma);
  const auto points = thin::noisyPoints(scene, sigma, static_cast<std::uint64_t>(s.seed) + 17);
  CloudView view = measure::viewOf(points);
  FitParams params;
  params.threads = s.threads;
  const auto own = fitOf(scene, view, params, least);
  if (!own) return own.error();
  params.sides = false;
  const auto off = fitOf(scene, view, params, least);
  if (!off) return off.error();
  std::vector<float> normals;
  for (const Vector3& n : scene.normals) normals.insert(normals.end(), n.begin(), n.end());
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const auto exact = fitOf(scene, view, params, least);
  if (!exact) return exact.error();
  std::printf("| %s | %zu | %g |", scene.name.c_str(), points.size(), sigma);
  for (const auto* outcome : {&*own, &*off, &*exact}) printOutcome(*outcome);
  for (const double value : {own->rms.thick, exact->rms.thick,
                             own->rms.thick / std::max(1e-3, exact->rms.thick), own->rms.thin})
    printValue(value);
  if (s.rivals) {
    const Errors mls = bestRival(scene, points, least, false);
    const Errors jets = bestRival(scene, points, least, true);
    printValue(std::min(jets.thin, mls.thin));
    printValue(std::min(jets.all, mls.all));
  }
  std::printf(" %.2f | %.2f |\n", own->fit.sides.confidence, own->seconds / off->seconds);
  std::fflush(stdout);
  return {};
}

Exit run(Settings& s) {
  if (Error error = finishOptions(s)) return Exit::usage(error);
  if (!s.cost_list.empty()) {
    if (Error error = thin::printCosts(s.cost_list, s.only, s.threads, s.seed)) return error;
    return {};
  }
  std::printf(
      "RMS distance (leaves) and noise found, in spacings; thick: where it is at least 1 spacing "
      "and 5 "
      "times the noise; best of CGAL's jets and MLS over six sizes\n\n| scene | points | noise | "
      "default | sides off | "
      "exact normals | thick: default | exact | ratio | thin: default |%s sure | CPU / off |\n",
      s.rivals ? " best rival | all: best rival |" : "");
  std::printf("|---|---|---|---|---|---|---|---|---|---|%s---|---|\n", s.rivals ? "---|---|" : "");
  for (const double sigma : s.noise_list) {
    for (const Scene& scene : thin::allScenes()) {
      if (scene.name.rfind(s.only, 0) != 0) continue;
      if (Error error = printRow(s, scene, sigma)) return error;
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer rows", [&] { return run(s); });
}

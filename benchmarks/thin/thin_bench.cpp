// SPDX-License-Identifier: BSD-3-Clause
// Thin parts: RMS distance to the exact surface of the default, beside a fit whose normals are exact,
// a fit without sides, and pcl::MovingLeastSquares and CGAL's jets at their best size with hindsight.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/run_program.h"
#include "fit/smoothed_points.h"
#include "measure/lists.h"
#include "rivals/jets.h"
#include "rivals/mls.h"
#include "thin/thin_scenes.h"

namespace {

using namespace pcl_slim;
using thin::Scene;

struct Settings {
  std::string noise = "0,0.1,0.3", only;
  int threads = 1, seed = 1;
  bool rivals = true;

  std::vector<double> noise_list;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("thin_bench", "1", "Measures fits of thin parts against exact surfaces.");
  options.text("noise", &s.noise, "S,...", "RMS errors along each axis, in spacings");
  options.text("only", &s.only, "TEXT", "scenes whose name begins with it; all if empty");
  options.toggle("rivals", &s.rivals, "run pcl::MovingLeastSquares and CGAL's jets");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the noise");
  options.integer("threads", &s.threads, 0, 4096, "threads of the fit, 0: all cores");
  return options;
}

Error
finishOptions(const OptionTable&, Settings& s)
{
  return measure::parseLists({{"noise", &s.noise, 0, 10, false, &s.noise_list}});
}

double
rmsOf(const Scene& scene, const std::vector<Vector3>& points)
{
  double sum = 0, count = 0;
  for (const Vector3& p : points) {
    if (!std::isfinite(p[0] + p[1] + p[2])) continue;
    sum += std::pow(scene.distance(p), 2);
    ++count;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

/** What a fit left of a scene's noise. */
struct Outcome {
  double rms = 0, sigma = 0, seconds = 0;
  FitStatistics fit;
};

Result<Outcome>
fitOf(const Scene& scene, const CloudView& view, const FitParams& params)
{
  const auto smoothed = measure::smoothPoints(view, params);
  if (!smoothed) return smoothed.error();
  return Outcome{rmsOf(scene, smoothed->points), smoothed->sigma, smoothed->seconds, smoothed->fit};
}

double
bestRival(const Scene& scene, const std::vector<Vector3>& points, bool jets)
{
  double best = 1e300;
  for (const double k : {12.0, 16.0, 24.0, 32.0, 64.0, 128.0}) {
    const auto moved = jets ? rivals::smoothByJets(points, static_cast<std::size_t>(k))
                            : rivals::smoothByMls(points, 2, std::sqrt(k / M_PI)).points;
    best = std::min(best, rmsOf(scene, moved));
  }
  return best;
}

Error
printRow(const Settings& s, const Scene& scene, double sigma)
{
  const auto points = thin::noisyPoints(scene, sigma, static_cast<std::uint64_t>(s.seed) + 17);
  CloudView view = measure::viewOf(points);
  FitParams params;
  params.threads = s.threads;
  const auto own = fitOf(scene, view, params);
  if (!own) return own.error();
  params.sides = false;
  const auto off = fitOf(scene, view, params);
  if (!off) return off.error();
  std::vector<float> normals;
  for (const Vector3& n : scene.normals) normals.insert(normals.end(), n.begin(), n.end());
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const auto exact = fitOf(scene, view, params);
  if (!exact) return exact.error();
  std::printf("| %s | %zu | %g | %.4f (%llu) | %.4f (%llu) | %.4f (%llu) |", scene.name.c_str(),
              points.size(), sigma, own->rms, static_cast<unsigned long long>(own->fit.leaves),
              off->rms, static_cast<unsigned long long>(off->fit.leaves), exact->rms,
              static_cast<unsigned long long>(exact->fit.leaves));
  std::printf(" %.3f %.3f %.3f | %.2f | %.2f |", own->sigma, off->sigma, exact->sigma,
              own->rms / std::max(exact->rms, 1e-4), own->seconds / off->seconds);
  if (s.rivals) {
    const double jets = rivals::hasJets() ? bestRival(scene, points, true) : NAN;
    std::printf(" %.4f | %.4f |", jets, bestRival(scene, points, false));
  }
  std::printf(" %.2f |\n", own->fit.sided_confidence);
  std::fflush(stdout);
  return {};
}

Error
printTable(const Settings& s)
{
  std::printf(
      "RMS distance (leaves), in spacings\n\n| scene | points | noise | default | sides off | "
      "exact normals | noise found: each | default / exact | CPU / off |%s sure |\n",
      s.rivals ? " jets | MLS |" : "");
  std::printf("|---|---|---|---|---|---|---|---|---|%s---|\n", s.rivals ? "---|---|" : "");
  for (const double sigma : s.noise_list) {
    for (const Scene& scene : thin::allScenes()) {
      if (scene.name.rfind(s.only, 0) != 0) continue;
      if (Error error = printRow(s, scene, sigma)) return error;
    }
  }
  return {};
}

}  // namespace

int
main(int argc, char** argv)
{
  return runProgram<Settings>(argc, argv, "give fewer rows", declareOptions, finishOptions,
                              printTable);
}

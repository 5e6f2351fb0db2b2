// SPDX-License-Identifier: BSD-3-Clause
#include "thin/thin_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "fit/smoothed_points.h"
#include "support/lab/bench.h"
#include "thin/thin_scenes.h"

namespace pcl_slim::thin {

namespace {

/** What a fit takes, the store included. */
struct Cost {
  double seconds = 0;  ///< processor time
  double sides = 0;    ///< of these, for the search for sides and for settling them
  double peak = 0;     ///< [MB]
  FitStatistics fit;
};

Result<Cost> costOf(const CloudView& view, const FitParams& params) {
  const measure::MemoryGauge memory;
  const double cpu = measure::cpuSeconds(), wall = measure::wallSeconds();
  auto store = PointStore::build(view, params.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  Cost cost;
  if (Error error = fitSurface(*store, params, surface, &cost.fit)) return error;
  cost.seconds = measure::cpuSeconds() - cpu;
  cost.sides = cost.fit.seconds.sides * cost.seconds / (measure::wallSeconds() - wall);
  cost.peak = memory.peakBytes() / 1e6;
  return cost;
}

/** The cheapest of three, for a machine that others use. */
Result<Cost> leastCost(const CloudView& view, const FitParams& params) {
  constexpr int kRepeats = 3;
  Result<Cost> least = costOf(view, params);
  for (int k = 1; least && k < kRepeats; ++k) {
    Result<Cost> next = costOf(view, params);
    if (!next) return next;
    if (next->seconds < least->seconds) least = std::move(next);
  }
  return least;
}

Error printCost(const Scene& scene, double sigma, int threads, int seed) {
  const auto points = noisyPoints(scene, sigma, static_cast<std::uint64_t>(seed) + 17);
  std::vector<float> normals;
  for (const Vector3& n : scene.normals) normals.insert(normals.end(), n.begin(), n.end());
  CloudView view = measure::viewOf(points);
  FitParams params;
  params.threads = threads;
  const auto own = leastCost(view, params);
  if (!own) return own.error();
  params.sides = false;
  const auto off = leastCost(view, params);
  if (!off) return off.error();
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const auto exact = leastCost(view, params);
  if (!exact) return exact.error();
  std::printf("| %s | %zu | %g | %.3f | %.3f | %.3f | %.3f | %.2f | %.0f | %.0f | %.0f | %.3f |\n",
              scene.name.c_str(), points.size(), sigma, own->sides, own->seconds, exact->seconds,
              off->seconds, own->seconds / exact->seconds, own->peak, exact->peak, off->peak,
              own->fit.sides.confidence);
  std::fflush(stdout);
  return {};
}

}  // namespace

Error printCosts(const std::vector<double>& sizes, const std::string& only, int threads, int seed) {
  constexpr double kGap = 2, kRadius = 2;
  struct Kind {
    bool tube;
    double sigma;
  };
  std::printf(
      "| scene | points | noise | sides, s | default, s | exact normals, s | sides off, s | "
      "default / "
      "exact | default, MB | exact, MB | off, MB | sure |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Kind kind : {Kind{false, 0.3}, Kind{false, 0.6}, Kind{true, 0.3}, Kind{true, 0.6}}) {
    for (const double size : sizes) {
      const Scene scene = turned(kind.tube ? tube(kRadius, size / (2 * M_PI * kRadius))
                                           : plates(kGap, std::sqrt(size / 2)));
      if (scene.name.rfind(only, 0) != 0) continue;
      if (Error error = printCost(scene, kind.sigma, threads, seed)) return error;
    }
  }
  return {};
}

}  // namespace pcl_slim::thin

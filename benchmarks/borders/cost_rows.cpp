// SPDX-License-Identifier: BSD-3-Clause
#include "borders/cost_rows.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "borders/closed_bodies.h"
#include "borders/lists.h"
#include "scan/cloud_file.h"
#include "support/lab/bench.h"

namespace pcl_slim::borders {
namespace {

/** \brief CPU seconds of one fit. */
Error timeFit(const PointStore& store, const FitParams& params, FitStatistics& statistics,
              double& seconds) {
  SLIMSurface surface;
  const double start = measure::cpuSeconds();
  if (Error error = fitSurface(store, params, surface, &statistics)) return error;
  seconds = measure::cpuSeconds() - start;
  return {};
}

/** \brief Which of a pair comes first alternates: a machine that slows down favours none. */
Error addRow(const CostSettings& s, const std::string& name, const CloudView& view) {
  const Result<PointStore> store = PointStore::build(view, s.fit.threads);
  if (!store) return store.error();
  FitStatistics statistics;
  std::vector<double> shares;
  double least[2] = {1e9, 1e9};
  for (int i = 0; i < s.repeat; ++i) {
    double seconds[2] = {};
    for (int k = 0; k < 2; ++k) {
      FitParams params = s.fit;
      params.trim = (i + k) % 2 == 1;
      FitStatistics own;
      double& took = seconds[params.trim ? 1 : 0];
      if (Error error = timeFit(*store, params, own, took)) return error;
      if (params.trim) statistics = own;
      least[params.trim ? 1 : 0] = std::min(least[params.trim ? 1 : 0], took);
    }
    shares.push_back(100.0 * (seconds[1] / seconds[0] - 1.0));
  }
  std::printf("| %s | %llu | %llu | %llu | %llu | %.3f | %.3f | %.3f | %.1f | %.1f |\n",
              name.c_str(), static_cast<unsigned long long>(statistics.points),
              static_cast<unsigned long long>(statistics.leaves),
              static_cast<unsigned long long>(statistics.open_leaves),
              static_cast<unsigned long long>(statistics.trim_candidates), least[0], least[1],
              1e6 * (least[1] - least[0]) / static_cast<double>(statistics.points),
              100.0 * (least[1] / least[0] - 1.0), measure::median(shares));
  std::fflush(stdout);
  return {};
}

}  // namespace

Error printCostRows(const CostSettings& settings) {
  constexpr std::size_t kPoints = 100000;
  std::printf(
      "| scene | points | leaves | open | candidates | fit s | with maps s | us/pt | %% more, "
      "least "
      "times | %% more, median of pairs |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, body] :
       {std::pair("sphere", measure::Body::kSphere), std::pair("torus", measure::Body::kTorus),
        std::pair("bumpy", measure::Body::kBumpy)}) {
    for (const auto& [level, noise] : {std::pair(" .1 %", 0.001), std::pair(" .5 %", 0.005)}) {
      const measure::Scene scene =
          measure::makeBody(body, measure::Spread::kRandom, kPoints, noise, 1);
      if (Error error =
              addRow(settings, std::string(name) + level, measure::viewOf(scene, nullptr, false)))
        return error;
    }
  }
  if (settings.files.empty()) return {};
  for (const std::string& file : wordsOf(settings.files)) {
    const Result<CloudFile> cloud = loadCloudFile(file);
    if (!cloud) return cloud.error();
    if (Error error = addRow(settings, file.substr(file.find_last_of('/') + 1),
                             cloud->view(settings.use_normals)))
      return error;
  }
  return {};
}

}  // namespace pcl_slim::borders

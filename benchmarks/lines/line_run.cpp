// SPDX-License-Identifier: BSD-3-Clause
#include "line_run.h"

#include "pcl_slim/cloud/point_store.h"
#include "support/lab/bench.h"

namespace pcl_slim::lines_bench {

Error runLines(const CloudView& cloud, FitParams fit, const CrestParams& params, LineRun& run) {
  run.points = cloud.count();
  const double n = static_cast<double>(cloud.count()) * 1e-6;
  double begin = measure::cpuSeconds();
  const auto store = PointStore::build(cloud, params.threads);
  if (!store) return store.error();
  fit.threads = params.threads;
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fit, surface)) return error;
  run.fit = (measure::cpuSeconds() - begin) / n;
  run.leaves = surface.numLeaves();
  begin = measure::cpuSeconds();
  ProjectionParams how;
  how.extremality = true;
  how.threads = params.threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, how, projection)) return error;
  run.project = (measure::cpuSeconds() - begin) / n;
  begin = measure::cpuSeconds();
  Error error = traceCrestLines(*store, projection, surface, params, run.lines, &run.statistics);
  run.trace = (measure::cpuSeconds() - begin) / n;
  return error;
}

std::vector<std::vector<measure::Segment>> segmentsOf(const CrestLines& lines) {
  std::vector<std::vector<measure::Segment>> made(2);
  for (std::size_t i = 0; i < lines.numLines(); ++i) {
    auto& segments = made[static_cast<std::size_t>(lines.type[i])];
    const std::uint32_t begin = lines.line_begin[i], end = lines.line_begin[i + 1];
    for (std::uint32_t v = begin; v + 1 < end; ++v) {
      segments.push_back({lines.position[v], lines.position[v + 1]});
    }
    if (lines.closed[i] != 0) segments.push_back({lines.position[end - 1], lines.position[begin]});
  }
  return made;
}

}  // namespace pcl_slim::lines_bench

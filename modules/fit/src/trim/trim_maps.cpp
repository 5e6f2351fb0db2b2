// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_maps.h"

#include <memory>

#include "pcl_slim/core/parallel.h"
#include "trim/trim_maker.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kRun = 64;  ///< surfels a thread takes at a time; no result depends on it

}  // namespace

void
makeTrimMaps(const PointStore& store, const FitSettings& settings, double hole_size,
             FitStatistics& stats, SLIMSurface& surface)
{
  PointBorders borders(store.size());
  std::vector<std::unique_ptr<TrimMaker>> makers;
  for (int t = 0; t < stats.threads; ++t)
    makers.push_back(std::make_unique<TrimMaker>(store, settings, hole_size, surface, borders));
  std::vector<std::uint8_t> sides(surface.size());
  std::vector<std::vector<std::uint8_t>> runs((surface.size() + kRun - 1) / kRun);
  parallelFor(runs.size(), stats.threads, 1, [&](std::size_t run, int thread) {
    const std::size_t end = std::min(surface.size(), (run + 1) * kRun);
    TrimMaker& maker = *makers[static_cast<std::size_t>(thread)];
    maker.prepare(run * kRun, end);
    for (std::size_t i = run * kRun; i < end; ++i) {
      const int side = maker.make(i, runs[run]);
      sides[i] = static_cast<std::uint8_t>(side);
    }
  });
  std::vector<std::uint8_t> bits;
  for (const auto& run : runs) bits.insert(bits.end(), run.begin(), run.end());
  surface.setTrimMaps(sides, bits);
  for (const auto& maker : makers) stats.trim_candidates += maker->numCandidates();
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/features/crest_lines.h"
#include "support/clouds.h"
#include "support/lab/line_truth.h"

namespace pcl_slim_test {

/** An exact surface's points, fitted, and projected with extremality. */
struct CrestFit {
  Fitted fit;
  pcl_slim::measure::LineSurface surface;
  double spacing = 0;

  CrestFit(const std::string& name, std::size_t count, double noise, std::uint64_t seed = 7) {
    EXPECT_TRUE(pcl_slim::measure::parseLineSurface(name, surface));
    const auto scene = pcl_slim::measure::sampleSurface(surface, count, noise, 0.05, seed);
    spacing = std::sqrt(pcl_slim::measure::areaOf(surface) / static_cast<double>(count));
    fit = fitted({scene.points, scene.normals});
    project();
  }

  void project() {
    pcl_slim::ProjectionParams how;
    how.extremality = true;
    how.threads = 1;
    EXPECT_FALSE(projectPoints(fit.store, fit.surface, how, fit.projection));
  }

  pcl_slim::CrestLines trace(const pcl_slim::CrestParams& params = {},
                             pcl_slim::CrestStatistics* statistics = nullptr) const {
    pcl_slim::CrestLines lines;
    const pcl_slim::Error error =
        traceCrestLines(fit.store, fit.projection, fit.surface, params, lines, statistics);
    EXPECT_FALSE(error) << error.message;
    return lines;
  }

  /** Lines against exact ones, both kinds together. */
  pcl_slim::measure::LineScore score(const pcl_slim::CrestLines& lines, std::size_t cells) const {
    return pcl_slim::measure::scoreLines(segments(lines),
                                         {pcl_slim::measure::exactLines(surface, false, cells),
                                          pcl_slim::measure::exactLines(surface, true, cells)},
                                         spacing);
  }

  static std::vector<std::vector<pcl_slim::measure::Segment>> segments(
      const pcl_slim::CrestLines& lines) {
    std::vector<std::vector<pcl_slim::measure::Segment>> made(2);
    for (std::size_t i = 0; i < lines.numLines(); ++i) {
      auto& kind = made[static_cast<std::size_t>(lines.type[i])];
      const std::uint32_t begin = lines.line_begin[i], end = lines.line_begin[i + 1];
      for (std::uint32_t v = begin; v + 1 < end; ++v) {
        kind.push_back({lines.position[v], lines.position[v + 1]});
      }
      if (lines.closed[i] != 0) kind.push_back({lines.position[end - 1], lines.position[begin]});
    }
    return made;
  }
};

}  // namespace pcl_slim_test

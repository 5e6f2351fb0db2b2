// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/fit/fit.h"
#include "support/lab/line_truth.h"

/** \brief Crest lines of a cloud, each stage on its own clock. */
namespace pcl_slim::lines_bench {

struct LineRun {
  CrestLines lines;
  CrestStatistics statistics;
  std::size_t points = 0, leaves = 0;
  double fit = 0, project = 0, trace = 0;  ///< us of CPU time a point
};

/** \brief Fits, projects and traces. */
Error runLines(const CloudView& cloud, FitParams fit, const CrestParams& params, LineRun& run);

/** \brief Lines as pieces, ridges and ravines, to be compared with exact ones. */
std::vector<std::vector<measure::Segment>> segmentsOf(const CrestLines& lines);

}  // namespace pcl_slim::lines_bench

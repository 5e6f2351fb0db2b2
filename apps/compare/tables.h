// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/program.h"
#include "compare/measurement.h"
#include "pcl_slim/compare/deviation_summary.h"

namespace pcl_slim {

/** \brief Prints the table of a comparison: the mean, what is significant, and the verdict on each
 * component that is not within its tolerance. */
void printSummary(const Comparison& comparison, const DeviationSummary& summary,
                  const DeviationSummaryParams& params, double registration_error,
                  Console& console);

/** \brief The same as an object "deviation" of a report, with the histogram. */
void reportSummary(const Comparison& comparison, const DeviationSummary& summary,
                   const DeviationSummaryParams& params, double registration_error, Report& report);

/** \brief The table as CSV: a line of names, one for all places and one for each component. */
std::string summaryCsv(const DeviationSummary& summary);

/** \brief The histogram as CSV: from, to, area and significant area of each bin. */
std::string histogramCsv(const DeviationSummary& summary);

/** \brief What a user reads of a comparison that is not within its tolerance: the components and
 * their share of area beyond the limits. */
std::string verdictText(const DeviationSummary& summary);

}  // namespace pcl_slim

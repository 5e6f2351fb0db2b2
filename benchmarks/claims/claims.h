// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "benchmark/runs.h"
#include "claims/claim_plan.h"
#include "common/progress_bar.h"

namespace pcl_slim::comparison {

/** \brief One figure, and what it should not exceed. */
struct ClaimRow {
  std::string scene;
  std::size_t points = 0;
  std::string run;       ///< the setting that gave it
  std::string quantity;  ///< what was measured
  double value = kNone;
  double goal = kNone;  ///< not a number: none, the figure stands for itself
  std::string beside;   ///< what the goal comes from, or what else was measured

  bool met() const { return value <= goal; }
};

/** \brief What one claim's scenes gave. */
struct ClaimTable {
  std::string name, title;
  std::vector<ClaimRow> rows;
};

/** \brief Names that measureClaim() knows. */
const std::vector<std::string>&
claimNames();

/** \brief Makes a claim's scenes, treats them and measures what the claim says. Progress goes to
 * the console; Ctrl-C cancels. */
Result<ClaimTable>
measureClaim(const std::string& name, const ClaimPlan& plan, Console& console);

/** \brief One row a figure, with a header. */
std::string
claimsCsv(const std::vector<ClaimTable>& tables);

/** \brief A Markdown table a claim. */
std::string
claimsMarkdown(const std::vector<ClaimTable>& tables);

}  // namespace pcl_slim::comparison

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ablation/cases.h"

namespace pcl_slim::ablation {

/** \brief How one figure changes over all cases: ratios of the changed fit's to the library's. */
struct Spread {
  double mean = 1;                 ///< geometric
  double least = 1, greatest = 1;  ///< ratios
  std::string least_case, greatest_case;
};

/** \brief How a change fares, case by case. */
struct Comparison {
  Spread position, normal, curvature, leaves, seconds, farthest;
  double uncovered = 0;  ///< points more than the library leaves, over all cases
  bool same = true;      ///< no figure but the time changes
};

/** \brief Compares a change's figures with the library's, both in the order of the cases. */
Comparison
compareFigures(const Cases& cases, const std::vector<Figures>& library,
               const std::vector<Figures>& changed);

/** \brief Header and row of the table, in Markdown. */
std::string
tableHeader();
std::string
tableRow(const std::string& name, const std::string& becomes, const Comparison& comparison);

}  // namespace pcl_slim::ablation

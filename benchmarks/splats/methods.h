// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "splats/colored_scan.h"

namespace pcl_slim::measure {

/** \brief One way to turn a scan into about so many splats. */
struct Method {
  std::string name;
  SplatParams params;
  enum class Solve { kGrid, kTolerances, kBudget } solve = Solve::kBudget;
};

/** \brief The ways that are compared: a uniform grid, geometry alone, both tolerances, the budget,
 * with and without gradients, and the published method. */
std::vector<Method> comparedMethods();

/** \brief Parameters with which a method gives a count near the one wanted: its grid's resolution
 * or the common factor of its tolerances is sought by bisection. */
SplatParams solvedFor(const ColoredScan& scan, const Method& method, std::size_t wanted);

}  // namespace pcl_slim::measure

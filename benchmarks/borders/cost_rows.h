// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim::borders {

struct CostSettings {
  FitParams fit;
  int repeat = 5;     ///< pairs of fits
  std::string files;  ///< scans, separated by commas
  bool use_normals = true;
};

/** \brief Prints what trim maps cost: pairs of fits without them and with them, in turn, of sphere, torus
 * and bumpy sphere with noise of .1 and .5 % of the diagonal, and of scans. CPU time.
 * \return an error for a file that cannot be read. */
Error printCostRows(const CostSettings& settings);

}  // namespace pcl_slim::borders

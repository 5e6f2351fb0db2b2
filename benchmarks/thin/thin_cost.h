// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim::thin {

/** \brief Prints what fits of thin noisy parts cost: processor time and memory of the default, beside
 * a fit whose normals are exact and one without sides.
 * \param[in] sizes numbers of points \param[in] only scenes whose name begins with it */
Error printCosts(const std::vector<double>& sizes, const std::string& only, int threads, int seed);

}  // namespace pcl_slim::thin

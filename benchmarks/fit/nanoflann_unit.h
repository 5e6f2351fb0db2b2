// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace pcl_slim::measure {

/** \brief CPU seconds of one unit, on one thread: a nanoflann tree over the points (x y z each, in
 * the order given), and per point its 10 nearest neighbours, their covariance and its eigenvalues.
 * Fit times in units compare across machines. */
double measureUnit(const std::vector<float>& xyz);

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "continuity/continuity_scan.h"

namespace pcl_slim::continuity {

/** \brief Median distance of points from the surface that their neighbours alone predict: weighted
 * polynomials of degree 1 to 3 over 8 to 80 neighbours, the best of all. What of a scan cannot be
 * predicted at its density is noise to every method that has its points alone. 2,000 random points
 * are tried [units of the points]. */
double unpredictable(const Points& points, std::uint64_t seed);

}  // namespace pcl_slim::continuity

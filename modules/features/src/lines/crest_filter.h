// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lines/crest_tracer.h"

namespace pcl_slim::detail {

/** Keeps the stretches of traced lines that stand out of the noise and are long and strong enough, and
 * counts the others. */
std::vector<TracedLine>
keptStretches(const std::vector<TracedLine>& traced, const CrestParams& params,
              CrestStatistics& statistics);

/** Sums along a line, a closed one's last side included, in the vertices' units. */
struct LineSums {
  double length = 0, strength = 0, radius = 0, significance = 0;

  explicit LineSums(const TracedLine& line);
};

}  // namespace pcl_slim::detail

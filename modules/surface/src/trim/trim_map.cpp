// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/trim_map.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim {

namespace {

/** The node nearest to a coordinate and the weights of it and its neighbours. */
struct SplineSupport {
  int node;
  double weight[3];

  SplineSupport(double coordinate, int side)
  {
    const double x = std::clamp(0.5 * (coordinate + 1.0), 0.0, 1.0) * (side - 1);
    node = static_cast<int>(x + 0.5);
    const double d = x - node;
    weight[0] = 0.5 * (0.5 - d) * (0.5 - d);
    weight[1] = 0.75 - d * d;
    weight[2] = 0.5 * (0.5 + d) * (0.5 + d);
  }
};

}  // namespace

double
outsideShare(const TrimMap& map, double u, double v)
{
  if (map.closed()) return 0.0;
  const SplineSupport column(u, map.side), row(v, map.side);
  double outside = 0.0;
  for (int j = 0; j < 3; ++j) {
    const int y = std::clamp(row.node + j - 1, 0, map.side - 1);
    for (int i = 0; i < 3; ++i) {
      const int x = std::clamp(column.node + i - 1, 0, map.side - 1);
      if (!map.at(x, y)) outside += column.weight[i] * row.weight[j];
    }
  }
  return outside;
}

}  // namespace pcl_slim

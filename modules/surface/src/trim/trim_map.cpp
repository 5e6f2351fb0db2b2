// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/trim_map.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/detail/trim_tables.h"

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

namespace pcl_slim::detail {

namespace {

/** Three bits: whether the nodes of a column in the rows about one are outside. */
std::uint32_t
columnCode(const TrimMap& map, int column, int row)
{
  const int x = std::clamp(column, 0, map.side - 1);
  std::uint32_t code = 0;
  for (int j = 0; j < 3; ++j) {
    const int y = std::clamp(row + j - 1, 0, map.side - 1);
    code |= static_cast<std::uint32_t>(!map.at(x, y)) << j;
  }
  return code;
}

void
appendTable(const TrimMap& map, std::vector<std::int32_t>& words)
{
  for (int row = 0; row < map.side; ++row) {
    for (int first = -1; first < map.side - 1; first += 8) {
      std::uint32_t word = 0;
      for (int k = 0; k < 10; ++k) word |= columnCode(map, first + k, row) << 3 * k;
      words.push_back(static_cast<std::int32_t>(word));
    }
  }
}

}  // namespace

TrimTables::TrimTables(const SLIMSurface& surface)
{
  if (!surface.hasTrimMaps()) return;
  begin_.resize(surface.size());
  sides_.resize(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TrimMap map = surface.trimMap(i);
    begin_[i] = static_cast<std::uint32_t>(words_.size());
    sides_[i] = static_cast<std::uint8_t>(map.side);
    appendTable(map, words_);
  }
}

}  // namespace pcl_slim::detail

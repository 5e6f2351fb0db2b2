// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/trim_tables.h"

#include <algorithm>

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

// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_columns.h"

#include <algorithm>
#include <string>
#include <vector>

namespace pcl_slim {

namespace detail {

void
mirrorTrimMap(std::uint8_t* map)
{
  const int side = map[0];
  const std::vector<std::uint8_t> copy(map + 1, map + 1 + TrimMap::numBytes(side));
  const TrimMap old{side, copy.data()};
  std::fill_n(map + 1, copy.size(), std::uint8_t{0});
  for (int k = 0; k < side * side; ++k) {
    const bool inside = old.at(k % side, side - 1 - k / side);
    map[1 + (k >> 3)] |= static_cast<std::uint8_t>(inside << (k & 7));
  }
}

Error
checkTrimMaps(const SLIMSurface& surface)
{
  const auto& begin = surface.trim_begin;
  const std::size_t n = surface.size();
  if (!begin.empty() &&
      (begin.size() != n + 1 || begin[0] != 0 || begin[n] != surface.trim_maps.size())) {
    return badInput("the trim maps do not belong to the surfels");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!surface.isOpen(i) && (begin.empty() || begin[i] == begin[i + 1])) continue;
    const bool there = surface.isOpen(i) && !begin.empty() && begin[i] < begin[i + 1] &&
                       begin[i + 1] <= surface.trim_maps.size();
    const int side = there ? surface.trim_maps[begin[i]] : 0;
    if (side < TrimMap::kLeastSide || side > TrimMap::kMostSide ||
        begin[i + 1] - begin[i] != 1 + TrimMap::numBytes(side)) {
      return badInput("the trim map of surfel " + std::to_string(i) + " has another size");
    }
  }
  return {};
}

}  // namespace detail

void
SLIMSurface::setTrimMaps(const std::vector<std::uint8_t>& sides,
                         const std::vector<std::uint8_t>& bits)
{
  dropTrimMaps();
  if (std::all_of(sides.begin(), sides.end(), [](std::uint8_t side) { return side == 0; })) return;
  trim_begin.resize(size() + 1);
  trim_maps.reserve(bits.size() + sides.size());
  auto next = bits.begin();
  for (std::size_t i = 0; i < size(); ++i) {
    trim_begin[i] = static_cast<std::uint32_t>(trim_maps.size());
    if (sides[i] == 0) continue;
    const auto end = next + static_cast<std::ptrdiff_t>(TrimMap::numBytes(sides[i]));
    trim_maps.push_back(sides[i]);
    trim_maps.insert(trim_maps.end(), next, end);
    flags[i] |= kSurfelOpen;
    next = end;
  }
  trim_begin[size()] = static_cast<std::uint32_t>(trim_maps.size());
  trim_maps.shrink_to_fit();
}

void
SLIMSurface::dropTrimMaps()
{
  trim_begin.clear();
  trim_maps.clear();
  for (std::uint8_t& flag : flags) flag &= static_cast<std::uint8_t>(~kSurfelOpen);
}

}  // namespace pcl_slim

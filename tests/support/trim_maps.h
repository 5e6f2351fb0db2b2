// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim_test {

/** Random trim maps of every side for two surfels of three; the others are closed. */
inline void setRandomTrimMaps(pcl_slim::SLIMSurface& surface) {
  using pcl_slim::TrimMap;
  std::mt19937 random(11);
  std::vector<std::uint8_t> sides(surface.size()), bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (i % 3 == 0) continue;
    constexpr int kSides = TrimMap::kMostSide - TrimMap::kLeastSide + 1;
    const int side = TrimMap::kLeastSide + static_cast<int>(i / 3) % kSides;
    sides[i] = static_cast<std::uint8_t>(side);
    std::vector<std::uint8_t> map(TrimMap::numBytes(side));
    for (int k = 0; k < side * side; ++k) {
      map[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>((random() & 1) << (k & 7));
    }
    bits.insert(bits.end(), map.begin(), map.end());
  }
  surface.setTrimMaps(sides, bits);
}

}  // namespace pcl_slim_test

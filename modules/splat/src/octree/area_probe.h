// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/octree_grid.h"
#include "octree/point_sample.h"

namespace pcl_slim::detail {

/** Resolutions that give about as many occupied cells as wanted: a surface's count grows with the
 * square of the resolution, and a coarse grid over some of the places tells the factor. */
class AreaProbe {
 public:
  template <typename T>
  AreaProbe(const octree_grid::Reader<T>& read, const PlaceSample& sample,
            const octree_grid::Box& box)
  {
    std::vector<std::uint64_t> seen((std::size_t{1} << 3 * kBits) / 64, 0);
    const double scale = kCells / box.longest();
    for (std::size_t k = 0; k < sample.size(); ++k) {
      T p[3];
      read(sample.point(k), p);
      std::size_t cell = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double at = (static_cast<double>(p[a]) - box.min[a]) * scale;
        cell = cell << kBits | static_cast<std::size_t>(std::min(at, kCells - 1.0));
      }
      seen[cell / 64] |= std::uint64_t{1} << cell % 64;
    }
    for (std::uint64_t word : seen) {
      for (; word != 0; word &= word - 1) ++occupied_;
    }
  }

  int resolutionFor(double wanted) const
  {
    const double ratio = std::max(wanted, 1.0) / std::max(occupied_, 1.0);
    return static_cast<int>(std::clamp(std::round(kCells * std::sqrt(ratio)), 1.0, 65536.0));
  }

 private:
  static constexpr int kBits = 6;  ///< the grid has 64 cells an axis
  static constexpr double kCells = 1 << kBits;
  double occupied_ = 0;
};

}  // namespace pcl_slim::detail

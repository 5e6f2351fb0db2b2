// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/octree_grid.h"
#include "octree/point_blocks.h"

namespace pcl_slim::detail {

/** Resolutions that give about as many occupied cells as wanted: a surface's count grows with the
 * square of the resolution, and a coarse grid tells the factor. Neither the order of the points nor
 * how often one is given changes it. */
class AreaProbe {
 public:
  static OctreeFrame frameOver(const octree_grid::Box& box)
  {
    return {box.min, kCells / box.longest(), std::nextafter(static_cast<float>(kCells), 0.0f)};
  }

  /** blocks: in the cells of frameOver(). */
  template <typename T>
  explicit AreaProbe(const PointBlocks<T>& blocks)
  {
    std::vector<std::atomic<std::uint64_t>> seen((std::size_t{1} << 3 * kBits) / 64);
    blocks.forEach([&](std::size_t, const PointBlock& block) {
      for (std::size_t k = 0; k < block.count; ++k) {
        const auto at = [](float c) { return static_cast<std::uint32_t>(c); };
        const std::uint32_t cell =
            (at(block.x[k]) << kBits | at(block.y[k])) << kBits | at(block.z[k]);
        const std::uint64_t bit = std::uint64_t{1} << cell % 64;
        std::atomic<std::uint64_t>& word = seen[cell / 64];
        // Most cells are known already: threads seldom write.
        if ((word.load(std::memory_order_relaxed) & bit) == 0) {
          word.fetch_or(bit, std::memory_order_relaxed);
        }
      }
    });
    for (const auto& word : seen) {
      for (std::uint64_t bits = word; bits != 0; bits &= bits - 1) ++occupied_;
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

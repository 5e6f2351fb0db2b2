// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** One point as the colour octree sees it. */
struct OctreePoint {
  float position[3];    ///< in root cells from the grid's low corner
  float normal[3];      ///< unit, or zero where the point has none
  float lab[3];         ///< CIELAB, or zero where the cloud has no colours
  std::uint32_t order;  ///< the i of CloudView::inputIndex(i)
};

/** Where points come from. */
struct OctreeSource {
  const CloudView& cloud;
  const ColorView& colors;
  const LabTable& table;
};

/** A stretch of a cloud's points along its curve, brought together in memory. */
class PointWindow {
 public:
  /** Fetches the points [begin, end). */
  void load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
            std::size_t end);

  std::size_t begin() const { return begin_; }
  std::size_t end() const { return begin_ + points_.size(); }
  /** The points from the i-th of the cloud on. */
  const OctreePoint* at(std::size_t i) const { return points_.data() + (i - begin_); }

  /** Sorts the points [first, last) by their keys and then the order they have; keys[k] becomes
   * the key of the k-th of them. */
  void sortRun(const OctreeCloud& cloud, std::size_t first, std::size_t last,
               AlignedVector<std::uint64_t>& keys);

 private:
  struct Keyed {
    std::uint64_t key;
    std::uint32_t at;
  };

  AlignedVector<OctreePoint> points_, sorted_;
  AlignedVector<Keyed> keyed_;
  std::size_t begin_ = 0;
};

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief The blocks near a cell, and those of them that the last ball asked for meets. One per
 * thread: it keeps its memory. */
class NearbyBlocks {
 public:
  /** \brief Collects the blocks that meet a box; the balls asked for next lie in it. */
  void collect(const BlockTree& tree, const float low[3], const float high[3])
  {
    neighborhood_.collect(tree, low, high);
    listed_radius_ = -1.0f;
  }

  /** \brief The blocks that meet a ball, ascending; valid until the next call. */
  const BlockList& within(const std::array<float, 3>& center, double radius)
  {
    const auto r = static_cast<float>(radius);
    if (r != listed_radius_ || center != listed_center_) {
      neighborhood_.blocksInBall(center.data(), r, blocks_);
      listed_center_ = center;
      listed_radius_ = r;
    }
    return blocks_;
  }

 private:
  BlockNeighborhood neighborhood_;
  BlockList blocks_;
  std::array<float, 3> listed_center_{};
  float listed_radius_ = -1.0f;  ///< blocks_ are those of a ball of this radius; < 0: of none
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cells/point_keys.h"
#include "pcl_slim/stream/tile_plan.h"

namespace pcl_slim::detail {

/** \brief Cells of a grid whose distance from a tile's points may be within a reach.
 *
 * Cells are a sixth to a twelfth of the reach wide, so what they hold beyond it is little. A function of
 * the points' set alone.
 */
class HaloMask {
 public:
  /** \param[in] plan,tile whose cells bound the mask \param[in] keys of the tile's points, any order
   * \param[in] reach local length. O(points + cells of the tile's box + cells with points times
   * reach squared in cells). */
  HaloMask(const TilePlan& plan, const TilePlan::Tile& tile,
           const AlignedVector<std::uint64_t>& keys, double reach);

  bool holds(std::uint64_t key) const { return hasCell(cellOf(key, depth_)); }
  /** \brief Whether some part of a plan's cell is in the mask. */
  bool meets(const TilePlan::Cell& cell) const;

 private:
  using Place = std::array<int, 3>;

  std::size_t indexOf(const Place& p) const;
  bool inside(const Place& p) const;
  bool hasCell(std::uint64_t code) const;
  bool fitBox(const TilePlan& plan, const TilePlan::Tile& tile, double reach);
  void markCore(const AlignedVector<std::uint64_t>& keys);
  void grow(double cells);

  int depth_ = 0;
  Place low_{}, size_{};
  std::vector<bool> bits_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cells/cell_counts.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/stream/tile_plan.h"
#include "scratch/tile_store.h"

namespace pcl_slim::detail {

/** \brief Cells of a grid whose distance from a tile's points may be within a reach.
 *
 * Cells are a sixth to a twelfth of the reach wide, so they contain little beyond it. A function of
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

/** \brief Brings tiles from disk into memory. */
class TileLoader {
 public:
  /** \param[in] halo other ranks' points near this one's tiles; none where one process has all */
  TileLoader(const TilePlan& plan, const TileStore& store, const TileStore& halo,
             const StoreFrame& frame, int threads)
      : plan_(plan), store_(store), halo_(halo), frame_(frame), threads_(threads)
  {
  }

  /** \brief Reads the points of a tile's core. */
  Error loadCore(std::size_t tile, std::vector<unsigned char>& records) const;
  /** \brief The mask of a tile's surroundings. \param[in] records its core */
  HaloMask maskOf(std::size_t tile, const std::vector<unsigned char>& records, double reach) const;
  /** \brief The cells that a mask meets outside a tile, ascending: they contain its halo. */
  std::vector<std::uint64_t> haloCells(std::size_t tile, const HaloMask& mask) const;
  /** \brief Appends the points of a tile's halo. */
  Error loadHalo(std::size_t tile, const HaloMask& mask, std::vector<unsigned char>& records) const;
  /** \brief Appends the points of some cells, [first, end), of which every thinning-th is kept, chosen
   * by its place. */
  Error loadCells(std::size_t first, std::size_t end, std::uint64_t thinning,
                  std::vector<unsigned char>& records) const;

  const TilePlan& plan() const { return plan_; }
  const PointRecord& record() const { return store_.record(); }

 private:
  template <typename Wanted>
  Error loadSome(const TileStore& store, const Bucket& bucket, const Wanted& wanted,
                 std::vector<unsigned char>& records) const;

  const TilePlan& plan_;
  const TileStore &store_, &halo_;
  const StoreFrame& frame_;
  int threads_;
};

}  // namespace pcl_slim::detail

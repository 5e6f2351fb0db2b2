// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/store_frame.h"
#include "scratch/tile_store.h"
#include "tiles/halo_mask.h"

namespace pcl_slim::detail {

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
  /** \brief The cells that a mask meets outside a tile, ascending: they hold its halo. */
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

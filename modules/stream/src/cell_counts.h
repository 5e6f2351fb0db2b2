// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/stream/tile_plan.h"

namespace pcl_slim::detail {

/** \brief Morton codes of the points of pieces, as a PointStore in the same frame computes them. */
class PointKeys {
 public:
  static constexpr std::uint64_t kLeftOut = ~std::uint64_t{0};

  PointKeys(const StoreFrame& frame, int threads) : frame_(frame), threads_(threads) {}

  /** \brief Computes the codes of a piece: one a point in order, kLeftOut for points that no store
   * takes. O(points). */
  const AlignedVector<std::uint64_t>& of(const CloudView& piece);

 private:
  void slice(const CloudView& piece, std::size_t begin, std::size_t end);

  const StoreFrame& frame_;
  int threads_;
  AlignedVector<std::uint64_t> keys_;
};

/** \brief Depth of the cells of the finest grid: Morton codes have three bits a level. */
constexpr int kDeepestCell = 21;

/** \brief Code of the cell of a depth that contains a point. */
inline std::uint64_t cellOf(std::uint64_t key, int depth) {
  return key >> (3 * (kDeepestCell - depth));
}

/** \brief Counts points in the cells of an octree that is deep where many points are.
 *
 * A table of depth 5 leads to pages of three levels, made when a point falls into them. One pass
 * over the cloud counts to depth 8; cells of too many points get pages of their own, which another
 * pass counts. Some 2 KB for each 32nd of the box's edge squared that a surface covers.
 */
class CellCounts {
 public:
  CellCounts();

  /** \brief Counts a piece's points by their codes. \return an error where a cell has 2^32 points.
   */
  Error add(const std::uint64_t* keys, std::size_t count);

  /** \brief Ends a pass. \return whether some cells of more than `most` points were divided, which
   * another pass has to count. */
  bool divideCells(std::uint64_t most);

  /** \brief The cells with points, ascending. */
  std::vector<TilePlan::Cell> cells() const;
  /** \brief Depth of the cells that the pass under way counts. */
  int depth() const { return depth_; }
  /** \brief Puts counts of cells of depth() in place of this pass's. \return an error where a cell
   * has 2^32 points. */
  Error replace(const std::vector<TilePlan::Cell>& cells);

  /** \brief Numbers the cells of cells(), for numberOf(). Counts are lost. */
  void numberCells();
  /** \brief The place among cells() of the cell that contains a code. */
  std::uint32_t numberOf(std::uint64_t key) const {
    std::uint32_t page = table_[cellOf(key, kTableDepth)];
    int depth = kTableDepth + kPageDepth;
    for (;; depth += kPageDepth) {
      const std::size_t slot = page * kPage + (cellOf(key, depth) & (kPage - 1));
      if (deeper_[slot] == 0) return values_[slot];
      page = deeper_[slot];
    }
  }

  std::size_t memoryBytes() const;

 private:
  static constexpr int kTableDepth = 5, kPageDepth = 3;
  static constexpr std::size_t kPage = std::size_t{1} << (3 * kPageDepth);
  static constexpr int kMostDepth = kTableDepth + 5 * kPageDepth;  ///< a page ends there

  std::uint32_t addPage();
  std::size_t slotOf(std::uint64_t key, int& depth);
  template <typename Visit>
  void forCells(const Visit& visit) const;
  template <typename Visit>
  void forPage(std::uint32_t page, std::uint64_t code, int depth, const Visit& visit) const;

  std::vector<std::uint32_t> table_;      ///< pages of the cells of depth 5; 0: none
  std::vector<std::uint32_t> values_;     ///< kPage a page: counts, then the cells' numbers
  std::vector<std::uint32_t> deeper_;     ///< the same: page of a cell that is divided, or 0
  int depth_ = kTableDepth + kPageDepth;  ///< of the cells that the pass under way counts
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

/** \brief Points of a store, cut into runs of one Morton cell each; cells have eight colours, and those
 * of one never touch. */
class CoverCells {
 public:
  struct Cell {
    std::uint32_t begin, end;  ///< range of the points
    std::uint64_t code;
  };

  /** \brief Cuts points, which ascend, into cells at least twice as wide as a reach. About the number
   * of cells in time, by steps along the points. */
  void divide(const PointStore& store, const AlignedVector<std::uint32_t>& points, double reach);

  std::size_t size() const { return cells_.size(); }
  const Cell& operator[](std::size_t i) const { return cells_[i]; }

  /** \brief Cells by colour; the largest of a colour come first, so that threads end together. */
  const std::vector<std::uint32_t>& byColor() const { return by_color_; }
  /** \brief Where a colour begins there, 0 to 7, and where the last ends, 8. */
  std::size_t colorBegin(int color) const { return color_begin_[static_cast<std::size_t>(color)]; }

  static std::size_t colorOf(const Cell& cell) { return cell.code & 7; }
  std::size_t colorOf(std::uint32_t i) const { return colorOf(cells_[i]); }

  /** \brief Calls body(j) for the cells that touch cell i; at the border of the space for some that
   * do not. */
  template <typename Body>
  void forTouching(std::uint32_t i, const Body& body) const
  {
    for (int step = 0; step < 27; ++step) {
      const std::uint32_t other = beside(i, step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      if (other != size() && other != i) body(other);
    }
  }

  std::size_t memoryBytes() const { return cells_.capacity() * sizeof(Cell); }

 private:
  /** The cell x, y, z steps along the axes from cell i; size() if there is none. */
  std::uint32_t beside(std::uint32_t i, int x, int y, int z) const;
  void orderByColor();

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> by_color_;
  std::array<std::size_t, 9> color_begin_{};
};

}  // namespace pcl_slim::detail

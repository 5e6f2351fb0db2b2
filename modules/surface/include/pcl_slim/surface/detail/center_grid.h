// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Entries from begin to end of some columns. */
struct ColumnRange {
  std::size_t begin, end;
};

namespace kernels {

/** \brief Finds the entries of x, y, z nearer to a place than a limit, in order.
 * \param[in] x,y,z columns with 16 values to spare behind the last entry.
 * \param[out] entries,distances_sq of those found, with 16 values to spare. \return how many. */
PCL_SLIM_EXPORT std::size_t entriesWithin(const float* x, const float* y, const float* z,
                                          const ColumnRange* ranges, std::size_t num_ranges,
                                          const float place[3], float limit_sq,
                                          std::uint32_t* entries, float* distances_sq);

}  // namespace kernels

/** \brief Some surfels, sorted by the cell of a grid as wide as the widest query. */
class PCL_SLIM_EXPORT CenterGrid {
 public:
  /** \param[in] members ascending. */
  CenterGrid(const SLIMSurface& surface, const std::vector<std::uint32_t>& members, float width);

  std::size_t size() const { return codes_.size(); }
  std::uint32_t memberAt(std::size_t place) const { return members_[place]; }

  /** The code of a cell, ascending along z, then y, then x, and a surfel in it. */
  struct Entry {
    std::int64_t cell;
    std::uint32_t surfel;
  };

  /** The members, in order of cells. */
  std::vector<Entry> entries() const;

  /** Any surfels, ascending, in order of this grid's cells; ascending within one. O(M). */
  std::vector<Entry> sortedByCell(const SLIMSurface& surface,
                                  const std::vector<std::uint32_t>& surfels) const;

  /** Calls body(member, squared distance) for the members within one cell of a place. */
  template <typename Body>
  void forEachNear(float px, float py, float pz, const Body& body) const {
    const std::int64_t x = cell(px), y = cell(py), z = cell(pz);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        // Cells along z are neighbours in the order of codes: one search finds three.
        const auto it = std::lower_bound(codes_.begin(), codes_.end(), code(x + dx, y + dy, z - 1));
        const std::int64_t last = code(x + dx, y + dy, z + 1);
        for (auto at = static_cast<std::size_t>(it - codes_.begin());
             at < size() && codes_[at] <= last; ++at) {
          const float ex = x_[at] - px, ey = y_[at] - py, ez = z_[at] - pz;
          body(members_[at], ex * ex + ey * ey + ez * ez);
        }
      }
    }
  }

  using Ranges = std::array<ColumnRange, 9>;

  /** \brief Finds what is within one cell of cells in ascending order, each in about the time it
   * takes to step there from the last. */
  class Walk {
   public:
    explicit Walk(const CenterGrid& grid) : codes_(grid.codes_) {}

    const Ranges& around(std::int64_t cell);

   private:
    const std::vector<std::int64_t>& codes_;
    Ranges rows_{};
    std::int64_t last_ = -1;
  };

  /** \brief Some members and their squared distances from a place. */
  struct Near {
    std::vector<std::uint32_t> places;  ///< in the sorted order
    std::vector<float> distances_sq;
    std::size_t count = 0;  ///< number of valid entries
  };

  /** Finds the members of some ranges that are within a squared distance of a place. */
  void findWithin(const Ranges& ranges, const float place[3], float limit_sq, Near& near) const;

 private:
  std::int64_t cell(float local) const;
  static std::int64_t code(std::int64_t x, std::int64_t y, std::int64_t z) {
    return x * (std::int64_t{1} << 42) + y * (std::int64_t{1} << 21) + z;
  }

  double inverse_;
  std::vector<std::int64_t> codes_;  ///< ascending
  std::vector<std::uint32_t> members_;
  std::vector<float> x_, y_, z_;  ///< and values to spare
};

}  // namespace pcl_slim::detail

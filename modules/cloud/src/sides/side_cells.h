// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Number, mean and covariance of some points. */
struct CellMoments {
  double count = 0;
  Vector3 mean{};
  std::array<double, 6> covariance{};  ///< xx, xy, xz, yy, yz, zz
};

/** \brief The points of a store, cut into cubes of one width; found by place through a hash table of
 * bricks of 4 x 4 x 4 cubes. */
class SideCells {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::size_t kWindow = 125;  ///< of 5 x 5 x 5 cubes

  /** \brief Cuts a store into cells. O(n). \param[in] wanted width, local length */
  SideCells(const PointStore& store, double wanted, int threads);

  /** \brief The cell at a place, or kNone. */
  std::uint32_t cellAt(const Vector3& place) const;

  /** \brief The cells in the window about a cell, itself included. \return how many. */
  std::size_t cellsAbout(std::uint32_t cell, std::array<std::uint32_t, kWindow>& found) const;

  std::vector<CellMoments> cells;      ///< in order of their Morton codes
  std::vector<std::uint32_t> cell_of;  ///< for each stored point
  double width;                        ///< local length

 private:
  /** The cells of 64 Morton codes in a row. */
  struct Brick {
    std::uint64_t code = 0;   ///< of the brick
    std::uint64_t cubes = 0;  ///< that have a cell, a bit each
    std::uint32_t first = 0;  ///< cell of these
  };

  void index(const std::vector<std::uint64_t>& codes);
  const Brick& brickOf(std::uint64_t code) const;

  std::vector<Brick> bricks_;
  std::vector<std::uint32_t> slots_;  ///< bricks by hashed code
};

}  // namespace pcl_slim::detail

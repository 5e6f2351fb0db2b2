// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/cloud/detail/signed_graph.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Number, mean and covariance of some points. */
struct CellMoments {
  double count = 0;
  Vector3 mean{};
  std::array<double, 6> covariance{};  ///< xx, xy, xz, yy, yz, zz
};

/** \brief The points of a store, cut into cubes of equal width. A hash table of bricks of 4 x 4 x 4
 * cubes finds the cube at a position. */
class SideCells {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::size_t kWindow = 125;  ///< 5 x 5 x 5 cubes

  /** \brief Cuts a store into cells. O(n).
   * \param[in] wanted width [local length]; the grid of Morton codes bounds it below */
  SideCells(const PointStore& store, double wanted, int threads);

  /** \brief The cell at a position, or kNone. */
  std::uint32_t cellAt(const Vector3& place) const;

  /** \brief Finds the cells in the window around a cell, itself included. \return their number */
  std::size_t cellsAbout(std::uint32_t cell, std::array<std::uint32_t, kWindow>& found) const;

  std::vector<CellMoments> cells;      ///< in order of their Morton codes
  std::vector<std::uint32_t> cell_of;  ///< the cell of each stored point
  double width;                        ///< [local length]

 private:
  /** The cells of 64 consecutive Morton codes. */
  struct Brick {
    std::uint64_t code = 0;   ///< Morton code of the brick
    std::uint64_t cubes = 0;  ///< one bit for each cube; 1: it contains points
    std::uint32_t first = 0;  ///< the first cell
  };

  void index(const std::vector<std::uint64_t>& codes);
  const Brick& brickOf(std::uint64_t code) const;

  std::vector<Brick> bricks_;
  std::vector<std::uint32_t> slots_;  ///< indices of bricks by hashed code
};

/** \brief Number of points, sums of their coordinates, and sums of their products: xx, xy, xz, yy,
 * yz, zz. */
using CellSums = std::array<double, 10>;

/** \brief The cells around a cell, in columns: number of points, offset of the mean from the middle
 * cell's, and covariance xx, xy, xz, yy, yz, zz. Columns are 0 beyond the last cell. */
struct NearCells {
  static constexpr std::size_t kCapacity = (SideConstants::kMostNeighbors + 7) / 8 * 8;
  alignas(64) std::array<std::array<double, kCapacity>, 10> columns;
};

/** \brief Two-means on the heights of cells, weighted by their points. */
struct TwoSheets {
  double square = 0;         ///< sum of the squared heights of the points over their mean
  double above = 0;          ///< number of points above the middle
  double gap = 0;            ///< distance of the two means; 0: there is one sheet
  std::uint64_t higher = 0;  ///< one bit for each cell; 1: it is above the middle
};

namespace kernels {

/** \brief Sums over the points of some cells, relative to the middle cell's mean.
 * \param[in] chosen one bit for each cell; 1: it is summed */
CellSums sumCells(const NearCells& near, std::uint64_t chosen);

/** \brief Separates the first cells into two sheets by their heights.
 * \param[in] mean of the heights along the normal */
TwoSheets separateCells(const NearCells& near, std::size_t count,
                        const std::array<double, 3>& normal, double mean, int passes);

}  // namespace kernels

/** \brief The cells that a cell's sheet is estimated from. */
struct SheetCells {
  /// The nearest cells, nearest first. The first one is the cell itself.
  std::array<std::uint32_t, SideConstants::kMostNeighbors> cells{};
  std::size_t count = 0;    ///< number of these that the normal is computed from
  std::uint64_t other = 0;  ///< one bit for each of them; 1: it is on another sheet, and left out

  bool isOther(std::size_t k) const { return (other >> k & 1) != 0; }
};

/** \brief The sheet through a cell. */
struct CellSheet {
  Vector3 normal{};          ///< unit normal of arbitrary sign
  double spread = 0;         ///< variance of the points along the normal
  double middle = HUGE_VAL;  ///< height of the middle of two sheets over the cell's mean
  Vector3 axis{};            ///< axis of a rod; 0: the sheet is no rod
  Vector3 radius{};          ///< from the axis of a rod to the cell's mean

  /** \brief Whether a point of the cell is on the other sheet. \param[in] offset from the mean */
  bool isBeyond(const Vector3& offset) const {
    return dot(offset, normal) * (middle < 0 ? -1 : 1) > std::abs(middle);
  }

  bool isRod() const { return axis != Vector3{}; }

  /** \brief Radial normal of a rod at a point of the cell. \param[in] offset from the mean */
  Vector3 rodNormal(const Vector3& offset) const {
    const Vector3 from_axis = along(along(offset, -dot(offset, axis), axis), 1, radius);
    return dot(from_axis, from_axis) > 0 ? normalized(from_axis) : normal;
  }
};

/** \brief Finds a cell's sheet: the flattest of several neighbourhoods. Where one contains two
 * sheets, the cells of the other sheet are left out. \param[out] cells the sheet is estimated from */
CellSheet sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants,
                  SheetCells& cells);

/** \brief Cells with normals of arbitrary sign, and edges between near cells. */
struct CellGraph {
  std::vector<CellSheet> sheets;
  std::vector<SignedEdge> edges;
  /// The cells on each cell's sheet among its nearest, itself included; as many for each, kNone where
  /// there are fewer.
  std::vector<std::uint32_t> neighbors;
};

/** \brief Computes the sheet of each cell, and the edges to its nearest cells and to the next sheet
 * along its normal. O(cells). */
CellGraph graphOf(const SideCells& cut, const SideConstants& constants, int threads);

}  // namespace pcl_slim::detail

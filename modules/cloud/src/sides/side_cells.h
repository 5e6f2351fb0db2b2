// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Number, mean and covariance of some points. */
struct CellMoments {
  double count = 0;
  Vector3 mean{};
  std::array<double, 6> covariance{};  ///< xx, xy, xz, yy, yz, zz
};

/** \brief The points of a store, cut into cubes of one width; found by place through a hash table
 * of bricks of 4 x 4 x 4 cubes. */
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

/** \brief Number of points, sums of their coordinates, and sums of their products xx, xy, xz, yy,
 * yz, zz. */
using CellSums = std::array<double, 10>;

/** \brief The cells near one, in columns: number of points, offset of their mean from the middle
 * cell's, and their covariance xx, xy, xz, yy, yz, zz. Columns are 0 beyond the last cell. */
struct NearCells {
  static constexpr std::size_t kRoom = (SideConstants::kMostNeighbors + 7) / 8 * 8;
  alignas(64) std::array<std::array<double, kRoom>, 10> columns;
};

/** \brief Two-means on the heights of cells, weighted by their points. */
struct TwoSheets {
  double square = 0;         ///< sum over the points of squared heights about their mean
  double above = 0;          ///< points above the middle
  double gap = 0;            ///< distance of the two means; 0: all are on one side
  std::uint64_t higher = 0;  ///< cells above the middle, a bit each
};

namespace kernels {

/** \brief Sums over the points of some cells, about the middle cell's mean.
 * \param[in] chosen cells, a bit each */
CellSums sumCells(const NearCells& near, std::uint64_t chosen);

/** \brief Parts the first cells by their heights. \param[in] mean of the heights along the normal
 */
TwoSheets partCells(const NearCells& near, std::size_t count, const std::array<double, 3>& normal,
                    double mean, int passes);

}  // namespace kernels

/** \brief The sheet through a cell, as the cells about it show it. */
struct CellSheet {
  std::array<std::uint32_t, SideConstants::kMostNeighbors> cells{};  ///< nearest first: itself
  std::size_t count = 0;     ///< of these, those that the normal is taken from ...
  std::uint64_t other = 0;   ///< ... but for the ones on another sheet, a bit each
  Vector3 normal{};          ///< unit, of no particular sign
  double spread = 0;         ///< variance of the points along it
  double middle = HUGE_VAL;  ///< height between two sheets above the cell's mean
  Vector3 axis{};            ///< of a rod, along which there is no normal; 0: no rod
  Vector3 radius{};          ///< from it to the cell's mean

  /** \brief Whether a point of the cell is on the other sheet. \param[in] offset from its mean */
  bool isBeyond(const Vector3& offset) const {
    return dot(offset, normal) * (middle < 0 ? -1 : 1) > std::abs(middle);
  }

  bool isRod() const { return axis != Vector3{}; }

  /** \brief A rod's normal at a point of the cell. \param[in] offset from its mean */
  Vector3 rodNormal(const Vector3& offset) const {
    const Vector3 from_axis = along(along(offset, -dot(offset, axis), axis), 1, radius);
    return dot(from_axis, from_axis) > 0 ? normalized(from_axis) : normal;
  }

  bool isOther(std::size_t k) const { return (other >> k & 1) != 0; }
};

/** \brief Finds a cell's sheet: the flattest of some neighbourhoods, of which the other sheet's
 * cells are dropped where there are two. */
CellSheet sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants);

/** \brief Two nodes, and how much they agree: > 0 if they should have the same sign, < 0 if
 * opposite ones. */
struct SignedEdge {
  std::uint32_t a, b;
  double agreement;
  bool apart = false;  ///< on two sheets
};

/** \brief Signs of the nodes of a graph, and the connected part that each belongs to. */
struct SignedParts {
  std::vector<signed char> signs;   ///< within a part; the whole part may be turned
  std::vector<std::uint32_t> part;  ///< for each node: the least node of its part
};

/** \brief Signs that make the sum of s_a s_b agreement large, by greedy additive contraction
 * (Keuper et al. 2015; signs as in correlation clustering): the two components with the strongest
 * summed agreement are joined, one of them turned if the sum is negative, until no edge is left
 * between components. Ties by nodes. \param[in] edges each pair once. O(edges log^2 edges). */
SignedParts contractSigned(std::size_t nodes, const std::vector<SignedEdge>& edges);

/** \brief Cells with their normals, of no particular sign, and edges between near cells. */
struct CellGraph {
  std::vector<CellSheet> sheets;
  std::vector<SignedEdge> edges;
};

/** \brief Normals by the moments of the nearest cells, those of a cell's own sheet where two run
 * through them; edges to these cells, and to the next sheet along the normal. O(cells). */
CellGraph graphOf(const SideCells& cut, const SideConstants& constants, int threads);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/detail/sides.h"

namespace pcl_slim::detail {

/** \brief Number of points, sums of their coordinates, and sums of their products xx, xy, xz, yy, yz, zz. */
using CellSums = std::array<double, 10>;

/** \brief The cells near one, in columns: number of points, offset of their mean from the middle cell's,
 * and their covariance xx, xy, xz, yy, yz, zz. Columns are 0 beyond the last cell. */
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
CellSums
sumCells(const NearCells& near, std::uint64_t chosen);

/** \brief Parts the first cells by their heights. \param[in] mean of the heights along the normal */
TwoSheets
partCells(const NearCells& near, std::size_t count, const std::array<double, 3>& normal,
          double mean, int passes);

}  // namespace kernels
}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "pcl_slim/cloud/detail/side_constants.h"
#include "sides/side_cells.h"

namespace pcl_slim::detail {

/** \brief The sheet through a cell, as the cells about it show it. */
struct CellSheet {
  std::array<std::uint32_t, SideConstants::kMostNeighbors> cells{};  ///< nearest first: itself
  std::size_t count = 0;     ///< of these, those that the normal is taken from ...
  std::uint64_t other = 0;   ///< ... but for the ones on another sheet, a bit each
  Vector3 normal{};          ///< unit, of no particular sign
  double spread = 0;         ///< variance of the points along it
  double middle = HUGE_VAL;  ///< height between two sheets above the cell's mean

  /** \brief Whether a point of the cell is on the other sheet. \param[in] offset from its mean */
  bool isBeyond(const Vector3& offset) const
  {
    return dot(offset, normal) * (middle < 0 ? -1 : 1) > std::abs(middle);
  }

  bool isOther(std::size_t k) const { return (other >> k & 1) != 0; }
};

/** \brief Finds a cell's sheet: the flattest of some neighbourhoods, of which the other sheet's cells are
 * dropped where there are two. */
CellSheet
sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants);

}  // namespace pcl_slim::detail

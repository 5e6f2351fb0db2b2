// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "pcl_slim/cloud/detail/sides.h"
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
  Vector3 axis{};            ///< of a rod, along which there is no normal; 0: no rod
  Vector3 radius{};          ///< from it to the cell's mean

  /** \brief Whether a point of the cell is on the other sheet. \param[in] offset from its mean */
  bool isBeyond(const Vector3& offset) const
  {
    return dot(offset, normal) * (middle < 0 ? -1 : 1) > std::abs(middle);
  }

  bool isRod() const { return axis != Vector3{}; }

  /** \brief A rod's normal at a point of the cell. \param[in] offset from its mean */
  Vector3 rodNormal(const Vector3& offset) const
  {
    const Vector3 from_axis = along(along(offset, -dot(offset, axis), axis), 1, radius);
    return dot(from_axis, from_axis) > 0 ? normalized(from_axis) : normal;
  }

  bool isOther(std::size_t k) const { return (other >> k & 1) != 0; }
};

/** \brief Finds a cell's sheet: the flattest of some neighbourhoods, of which the other sheet's cells are
 * dropped where there are two. */
CellSheet
sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants);

}  // namespace pcl_slim::detail

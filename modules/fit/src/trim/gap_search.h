// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "trim/bit_rows.h"
#include "trim/known_region.h"
#include "trim/sheet_points.h"

namespace pcl_slim::detail {

/** \brief Looks for gaps in a surfel's points, much faster than they are measured.
 *
 * Cells that hold points are marked; a gap is a round patch, six cells wide, without any, inside
 * what is known of the surfel's surroundings. One per thread: it keeps its memory.
 */
class GapSearch {
 public:
  /** \brief Finds places where points may leave a gap. \param[in] hole diameter of the smallest gap, in
   * radii of the surfel. \param[out] places of the (u, v) plane in such gaps, in units of the surfel's radius;
   * some, evenly chosen. O(points + cells / 64). */
  void find(const SheetPoints& points, const KnownRegion& known, double hole,
            const TrimConstants& constants, std::vector<std::array<double, 2>>& places);

 private:
  void listEmptyPatches(double cell, std::vector<std::array<double, 2>>& places);

  BitRows held_;                    ///< cells with points, or of which nothing is known
  BitRows long_runs_, short_runs_;  ///< cells that begin six or four empty ones in their row
};

}  // namespace pcl_slim::detail

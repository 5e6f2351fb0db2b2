// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "trim/bit_rows.h"
#include "trim/known_region.h"
#include "trim/sheet_points.h"

namespace pcl_slim::detail {

/** \brief What a raster measures by, in units of the surfel's radius. */
struct TrimScale {
  double spacing;  ///< of the surfel's points
  double hole;     ///< diameter of the smallest hole kept
  double growth;   ///< how far the surface extends beyond its outermost points
};

/** \brief The depth of places of a surfel's disc inside its data, on a raster.
 *
 * The points' region is closed by discs of the smallest hole's diameter, then grown: with R the
 * discs' radius, a place nearer than R to a point is covered, D is a covered place's distance to
 * what is not, and its depth D - (R - growth). Depths are smoothed. Integers throughout; one per
 * thread: it keeps its memory.
 */
class TrimRaster {
 public:
  /** \brief Lists the places of a region that are not covered, in units of the surfel's radius.
   * O(points + cells / 64) where there are none. */
  void findGaps(const SheetPoints& points, const KnownRegion& sure, const TrimScale& scale,
                const TrimConstants& constants, std::vector<std::array<double, 2>>& places);

  /** \brief Measures the depths, after findGaps() of the same points. What is not known counts as covered.
   * O(points + cells). */
  void measureDepths(const SheetPoints& points, const KnownRegion& known);

  /** \brief The least depth within a share of the radius, in cells / 64. */
  int leastDepth(double share) const;

  /** \brief Width of a cell in units of the surfel's radius. */
  double cell() const { return cell_; }

  /** \brief Sets those bits of a map of side x side nodes, all 0 before, that are inside. */
  void fillMap(int side, std::uint8_t* bits) const;

 private:
  void setScale(const TrimScale& scale, const TrimConstants& constants);
  void markEmpty(const SheetPoints& points);
  void markEmptyDiscs(const SheetPoints& points);
  void markNearGaps(int reach);
  void coverGaps(const SheetPoints& points);
  void dropCovered(const SheetPoints& points, std::vector<std::array<double, 2>>& places) const;
  void cutDisc(int rows, int span);
  void listGaps(std::vector<std::array<double, 2>>& places) const;
  void findRowDistances(int cap);
  bool findDistances(int y, int cap, std::int16_t* distance_sq) const;
  void spreadDistances(int cap);
  void findDepths(int cap, double offset);
  void smoothRows();
  void smoothColumns();
  int depthAt(int x_fixed, int y_fixed) const;

  double cell_ = 0.0;
  double reach_ = 0.0, growth_ = 0.0;  ///< radius of the discs and TrimScale's growth, in cells
  int half_ = 0, side_ = 0;            ///< cells from the middle, and in all
  bool all_covered_ = false;           ///< not only those of findGaps()'s region
  BitRows filled_;                     ///< cells whose disc covers a whole cell with points
  BitRows covered_, unsure_, near_gaps_, scratch_bits_;
  std::vector<BitRows>
      eroded_;  ///< [k]: cells that are empty with k neighbours on either side in the row
  std::vector<int> run_halves_;            ///< of a disc's rows
  std::vector<std::size_t> whole_halves_;  ///< likewise of the cells that it contains whole
  std::vector<std::uint8_t> row_has_gap_;
  int stride_ = 0;  ///< of the rows below: whole vectors
  std::vector<std::int16_t> row_distance_sq_, distance_sq_, depth_, scratch_, depth_of_sq_;
};

}  // namespace pcl_slim::detail

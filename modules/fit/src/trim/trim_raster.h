// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  double growth;   ///< how far the surface goes on beyond its outermost points
};

/** \brief How deep the places of a surfel's disc lie inside its data, on a raster.
 *
 * The points' region is closed by discs of the smallest hole's diameter, then grown: with R the
 * discs' radius, a place nearer than R to a point is covered, D is a covered place's distance to
 * what is not, and its depth D - (R - growth). Depths are smoothed. Integers throughout; one per
 * thread: it keeps its memory.
 */
class TrimRaster {
 public:
  /** \brief Measures the depths. \return false if every place is covered. O(points + cells). */
  bool measure(const SheetPoints& points, const KnownRegion& known, const TrimScale& scale,
               const TrimConstants& constants);

  /** \brief Whether a place within a radius is uncovered: one whose disc of the smallest hole's
   * diameter the gathered points tell enough of. Beyond, chance leaves half discs empty. */
  bool hasGapWithin(const KnownRegion& sure);

  /** \brief The least depth within a share of the radius, in cells / 64. */
  int leastDepth(double share) const;

  /** \brief Width of a cell in units of the surfel's radius. */
  double cell() const { return cell_; }

  /** \brief Sets those bits of a map of side x side nodes, all 0 before, that are inside. */
  void fillMap(int side, std::uint8_t* bits) const;

 private:
  void cutDisc(double reach, int rows, int span);
  void cover(const SheetPoints& points, double reach);
  void findRowDistances(int cap);
  void spreadDistances(int cap);
  void findDepths(int cap, double offset);
  void smoothRows();
  void smoothColumns();
  int depthAt(int x_fixed, int y_fixed) const;

  double cell_ = 0.0;
  int half_ = 0, side_ = 0;  ///< cells from the middle, and in all
  BitRows covered_, unsure_;
  std::vector<int> run_halves_;  ///< of a disc's rows
  std::vector<std::uint8_t> row_has_gap_;
  std::vector<std::int16_t> row_distance_sq_, distance_sq_, depth_, scratch_, depth_of_sq_;
};

}  // namespace pcl_slim::detail

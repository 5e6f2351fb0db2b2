// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "gaps/gap_chains.h"
#include "gaps/gap_grid.h"

namespace pcl_slim::detail {

/** \brief Tells gaps in a surfel's points from what chance leaves empty (docs/theory.md, "Borders").
 *
 * Among points spread at random, rho a unit of area, 2 (1 + y) exp(-y) discs a point are empty and
 * as wide as three points around allow, with y = pi rho times a disc's radius squared or more
 * (Miles 1970). A gap is real if it goes on to an empty disc too wide for a cloud of so many
 * points. One per thread: it keeps its memory.
 */
class GapEvidence {
 public:
  /** \param[in] points of the cloud */
  GapEvidence(const TrimConstants& constants, std::size_t points);

  /** \brief Radius of what must be seen of a surfel's surroundings, in its radii. */
  double view(double spacing) const
  {
    return std::max(constants_.known, constants_.view * chance_ * spacing);
  }

  /** \brief Finds the gaps of a leaf's points. O(points + cells). \return whether there is one.
   * \param[in] spacing of the points, and hole: diameter of the smallest gap; radii of the surfel
   * \param[in] with_folds also where the sheet turns away from the plane */
  bool findGaps(const SheetPoints& points, const SheetHeight& sheet, const KnownRegion& known,
                double spacing, double hole, bool with_folds);

  const GapGrid& gaps() const { return near_; }

  /** \brief Whether gaps() may be real: where all that is looked at was known, they have a disc wide
   * enough, or one a cell narrower. Changes the middles of their discs. */
  bool mayBeReal()
  {
    const double widest = std::max(hole_, chance_ * spacing_) - 2.0 / near_.cellsPerUnit();
    return view(spacing_) > constants_.known || near_.findCenters(widest);
  }

  /** \brief A place in each of the gaps just found that is real. \param[in] seen points within
   * view(): those of findGaps() where no more was gathered */
  void findReal(const SheetPoints& seen, const SheetHeight& sheet,
                std::vector<LeafGaps::Place>& real);

 private:
  void findUnlikely(double diameter);
  bool addReal(std::vector<LeafGaps::Place>& real);

  const TrimConstants& constants_;
  double rarest_;  ///< points missing from the emptiest disc that chance explains
  double chance_;  ///< its diameter in spacings
  double spacing_ = 0.0, hole_ = 0.0;
  GapGrid near_, wide_;
  BitRows middles_,
      real_;  ///< cells of wide_: middles of discs too empty for chance, and their cells
  std::vector<std::uint8_t> done_;  ///< gaps of near_
};

}  // namespace pcl_slim::detail

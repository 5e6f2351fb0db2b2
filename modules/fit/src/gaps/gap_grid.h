// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "trim/bit_rows.h"
#include "trim/known_region.h"
#include "trim/sheet_points.h"

namespace pcl_slim::detail {

/** \brief A surfel's polynomial, in units of its radius. */
struct SheetHeight {
  int degree;
  const float* c;
};

/** \brief Cells of a surfel's (u, v) plane: which hold points, which are unknown, and the gaps: connected
 * unions of empty discs. One per thread: it keeps its memory. */
class GapGrid {
 public:
  /** \brief Cells of a gap side by side in a row. */
  struct Run {
    int y, first, last, gap;
  };

  /** \brief Marks the cells of a disc about the centre that hold points; what is not known is no gap.
   * \param[in] view radius of the disc, and cell: a cell's width, both in radii of the surfel; cells
   * are wider where more than 254 would be in a row */
  void mark(const SheetPoints& points, const KnownRegion& known, double view, double cell);

  /** \brief Makes unknown what lies beyond the outermost points of each row and column where the
   * sheet is steeper than a slope: there it turns away from the plane, and has no border. */
  void hideFolds(const SheetHeight& sheet, double steepest);

  /** \brief Finds the gaps. \param[in] diameter of the discs, radii of the surfel. \return whether there
   * is one. O(diameter * cells / 64) */
  bool findGaps(double diameter);

  /** \brief Marks the middles of empty discs of a diameter. \return whether there is one. */
  bool findCenters(double diameter);

  /** \brief How many middles were marked. */
  std::size_t numCenters() const;

  /** \brief How many points are missing from an empty disc about a cell's middle: its area times the
   * density of the points around it, from the share of cells that hold some. */
  double numMissing(int x, int y, double diameter) const;

  /** \brief Adds to a set of cells the discs of a diameter about some others. */
  void addDiscs(const BitRows& middles, double diameter, BitRows& cells);

  int numGaps() const { return num_gaps_; }
  const std::vector<Run>& runs() const { return runs_; }

  int side() const { return occupied_.side(); }
  /** \brief The cell of a coordinate, which may be none of the grid's. */
  int cellOf(double coordinate) const
  {
    return static_cast<int>(std::floor(coordinate / cell_ + half_));
  }
  double cellsPerUnit() const { return 1.0 / cell_; }
  int half() const { return half_; }

  /** \brief The middle of a cell. */
  double middle(int k) const { return cell_ * (k + 0.5 - half_); }

  /** \brief Whether a cell is the middle of an empty disc. */
  bool isCenter(int x, int y) const { return centers_.test(x, y); }

 private:
  void hideAlongRows(const SheetHeight& sheet);
  void hideAlongColumns(const SheetHeight& sheet, bool upwards);
  bool isSteep(const SheetHeight& sheet, int x, int y) const;
  void markCenters(double reach);
  void findRuns();
  int rootOf(int run);
  void joinRuns();
  void numberGaps();

  double cell_ = 0.0;  ///< width of a cell in radii of the surfel
  int half_ = 0;       ///< cells from the middle to the end
  double steepest_sq_ = 0.0;
  BitRows occupied_, beyond_, closed_, centers_, empty_, scratch_, discs_;
  std::vector<std::uint64_t> columns_;
  std::vector<Run> runs_;
  std::vector<int> parents_;  ///< of runs: an earlier run of the same gap, or the run itself
  int num_gaps_ = 0;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "ball/ball_frame.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

/** \brief The interval of residuals that belongs to the centre's sheet. */
struct SheetRange {
  bool split = false;
  float low = 0, high = 0;
};

/** \brief Looks for two sheets in the residuals of one ball (docs/theory.md, "Sheets").
 *
 * Otsu's threshold on a histogram; two sheets only if the valley between the peaks is low, and the
 * sides stand apart against their own thickness. \param[in] center_residual residual of the ball's
 * centre. O(count).
 */
SheetRange
findSheet(const float* residuals, std::size_t count, double center_residual,
          const SheetConstants& constants = {});

/** \brief Keeps the centre's sheet of balls that hold two. One per thread: it keeps its memory. */
class SheetSplitter {
 public:
  /** \brief Where the residuals at r_r show two sheets, drops the other one's points and frames the
   * ball anew. \param[in,out] search begun on the ball, and begun anew on what is left of it. */
  FramedBall ownSheet(FramedBall ball, const SheetConstants& constants, RadiusSearch& search);

  /** \brief Balls that were parted so far. */
  std::uint64_t numSplit() const { return split_; }

 private:
  SheetRange sheetAt(const FramedBall& ball, const SheetConstants& constants, RadiusSearch& search);

  BallBuffer kept_;
  std::vector<float> residuals_;
  std::uint64_t split_ = 0;
};

}  // namespace pcl_slim::detail

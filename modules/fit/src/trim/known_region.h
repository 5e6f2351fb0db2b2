// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "trim/bit_rows.h"

namespace pcl_slim::detail {

/** \brief The part of a surfel's (u, v) plane that the gathering ball covers: where the surfel's surface is
 * inside that ball. A surface that bends leaves the ball before its rim. */
class KnownRegion {
 public:
  /** \param[in] c coefficients of the surfel \param[in] radius of the ball, in the surfel's radii */
  KnownRegion(int degree, const float* c, double radius);

  /** \brief Sets the bits of cells beyond. Cell (x, y) is at cell times (x - middle, y - middle).
   * O(rows).
   * Where the surface bends, the cells before are those connected to the middle. */
  void markBeyond(double cell, int middle, BitRows& rows) const;

  /** \brief Likewise as if the surface were flat: no cell more. O(rows), faster. */
  void markBeyondCircle(double cell, int middle, BitRows& rows) const;

 private:
  struct Run {
    int first, last;  ///< empty if last < first
  };

  Run circleRun(double v, double cell, double middle, int end) const;
  Run narrowed(Run circle, Run from, double cell, double middle, double v) const;

  int degree_;
  const float* c_;
  double radius_;
  double highest_;  ///< bound on |h| in the ball
};

}  // namespace pcl_slim::detail

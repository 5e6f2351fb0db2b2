// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "trim/bit_rows.h"

namespace pcl_slim::detail {

/** \brief The part of a surfel's (u, v) plane that gathered points tell of: where its own surface lies
 * in the ball they were gathered from. A surface that bends leaves that ball before its rim. */
class KnownRegion {
 public:
  /** \param[in] c coefficients of the surfel \param[in] radius of the ball, in the surfel's radii */
  KnownRegion(int degree, const float* c, double radius);

  /** \brief Sets the bits of cells beyond. Cell (x, y) stands at cell times (x - middle, y - middle).
   * O(rows), and somewhat more where the surface bends. */
  void markBeyond(double cell, double middle, BitRows& rows) const;

 private:
  bool holds(double u, double v) const;

  int degree_;
  const float* c_;
  double radius_;
  double highest_;  ///< bound on |h| in the ball
};

}  // namespace pcl_slim::detail

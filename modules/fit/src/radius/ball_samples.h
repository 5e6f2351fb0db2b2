// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 4 (One ball): every radius is evaluated from the points
// that were gathered once.
#pragma once

#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief The samples of one gathered ball, and copies of its inner parts.
 *
 * The radii of a level lie in [gamma^2, 1] r_r (eq. 5). The points within gamma r_r and those
 * within gamma^2 r_r are copied when a radius first needs no more than them, so that small radii
 * do not read the whole ball. Radii are in units of the gather radius. There is one object per
 * thread, which keeps its scratch memory.
 */
class BallSamples {
 public:
  /** \brief Starts on a ball in frame coordinates, which must stay as it is until the next one.
   * \param[in] gather_radius local length; \param[in] rho_right r_r in units of it. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right);

  /** \brief All points, or a smaller copy that still holds all within rho. O(points) when new. */
  const BallBuffer& within(double rho);

  const BallBuffer& all() const { return *ball_; }
  double gatherRadius() const { return gather_radius_; }
  double rhoRight() const { return rho_right_; }

 private:
  const BallBuffer* ball_ = nullptr;
  BallBuffer middle_, inner_;
  bool has_middle_ = false, has_inner_ = false;
  double gather_radius_ = 0, rho_right_ = 1;
};

}  // namespace pcl_slim::detail

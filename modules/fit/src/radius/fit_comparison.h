// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Two fits on the same points": how wide, and of how low a degree, a leaf may be
// that holds noise only.
#pragma once

#include <array>

#include "radius/residual_tests.h"

namespace pcl_slim::detail {

/** \brief Compares a simpler fit, of a wider ball or a lower degree, with a closer one on the same
 * points.
 *
 * E compares radii over different points: a narrow ball's is often lower by luck, or because the
 * wide one's rim bends more than a polynomial, which hardly counts: where leaves are blended by
 * the weights they were fitted with, such errors of neighbours cancel to first order. On the same
 * points noise cancels: if both fits are unbiased, their mean squared difference D^2 is about the
 * variance that the simpler one saves, lambda (P_close / n_close - P_simpler / n_simpler).
 */
class FitComparison {
 public:
  FitComparison(TrialFits& trials, ResidualTests& tests) : trials_(trials), tests_(tests) {}

  /** \brief Whether the simpler fit costs the closer one's points less than it saves them.
   * \param[in] trust as many times as much may be lost. O(P^2). */
  bool acceptsSimpler(const Trial& simpler, const Trial& close, double trust = 1.0) const;

  /** \brief The widest ball from r_r down to r_m, r_m left out, that is accepted in place of r_m's
   * and hides no detail: r_r, or else upwards from r_m. \return an unsupported trial where there
   * is none. */
  Trial widestAccepted(const Trial& middle, const Trial& right);

  /** \brief The fit of the lowest degree that is accepted in place of a leaf's: under noise the
   * high terms of a ball that cannot be wide hold little else. */
  Trial lowestDegreeAccepted(const Trial& trial);

 private:
  std::array<double, kMaxCoefficients> unbiased(const Trial& trial) const;
  double meanSquaredDifference(const Trial& simpler, const Trial& close) const;

  TrialFits& trials_;
  ResidualTests& tests_;
};

}  // namespace pcl_slim::detail

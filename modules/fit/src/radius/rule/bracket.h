// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): the minimum of E inside an interval, rule
// (4) of the paper, by the parabolic steps of Brent's method.
#pragma once

#include "radius/trial_fits.h"

namespace pcl_slim::detail {

/** \brief Three trials a < b < c of which the middle one costs least. */
struct Bracket {
  Trial a, b, c;

  /** \brief One parabolic step in log r and log E towards the minimum near b. One fit. */
  void narrow(TrialFits& trials);

  /** \brief log(c / a). */
  double width() const;
};

}  // namespace pcl_slim::detail

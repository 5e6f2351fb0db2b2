// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Guards", Lack of fit; "Detail below the noise"; and what "holds noise only"
// means in "Two fits on the same points".
#pragma once

#include "radius/residual_structure.h"
#include "radius/trial_fits.h"

namespace pcl_slim::detail {

/** \brief Tells whether what a fit leaves over is noise, lack of fit, or detail below the noise. */
class ResidualTests {
 public:
  explicit ResidualTests(TrialFits& trials) : trials_(trials), structure_(trials.constants()) {}

  /** \brief The residual is no larger than noise makes it. */
  bool isNoise(const Trial& trial) const
  {
    return trials_.variance(trial) <= trials_.constants().noise_like * trials_.noise();
  }

  /** \brief The smaller residual of two fits is beyond what noise explains, times a margin. */
  bool lacksFit(const Trial& left, const Trial& middle, double margin = 1.0) const;
  bool lacksFit(const Trial& trial) const { return lacksFit(trial, trial); }

  /** \brief Neighbouring residuals share so much that smaller balls are worth their noise.
   * O(points). */
  bool hidesDetail(const Trial& trial);

 private:
  TrialFits& trials_;
  ResidualStructure structure_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <vector>

// docs/theory.md, "Guards", Lack of fit; "Detail below the noise"; and "contains noise only"
// in "Two fits on the same points".
#pragma once

#include "fit_constants.h"
#include "radius/trial_fits.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief Separates a surface's unresolved detail from noise by the covariance of neighbouring residuals.
 *
 * Noise differs from point to point; detail that a fit misses is common to points that are close
 * together in the frame's plane. The mean product of residuals over all pairs within small cells
 * of (u, v) therefore estimates the detail's variance, whatever the noise is: a lack-of-fit test
 * with near replicates. One object per thread: it keeps its scratch memory.
 */
class ResidualStructure {
 public:
  explicit ResidualStructure(const RadiusConstants& constants) : constants_(constants) {}

  struct Finding {
    double share = 0;      ///< of e^2 that neighbours have in common
    double deviation = 0;  ///< standard deviation of share where there is noise alone; 0: unknown
  };

  /** \brief Looks at the residuals of a fit within rho. \param[in] least_cell least width of a
   * cell; 0: from the points' density. \param[in] correlation points that share their noise.
   * O(points). */
  Finding measure(const BallBuffer& points, const LocalFit& fit, double rho,
                  double least_cell = 0.0, double correlation = 1.0);

 private:
  /** \brief A cell of the frame's plane. */
  struct Cell {
    float count, sum;  ///< points and the sum of their residuals
  };

  int cellsAlongSide(double points, double rho, double least_cell) const;
  double fillCells(const BallBuffer& points, double rho, int side);

  const RadiusConstants& constants_;
  std::vector<float> residuals_;
  std::vector<Cell> cells_;
};

/** \brief Decides whether the residuals of a fit are noise, lack of fit, or detail below the noise. */
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
   * high terms of a ball that cannot be wide are little else. */
  Trial lowestDegreeAccepted(const Trial& trial);

 private:
  std::array<double, kMaxCoefficients> unbiased(const Trial& trial) const;
  double meanSquaredDifference(const Trial& simpler, const Trial& close) const;

  TrialFits& trials_;
  ResidualTests& tests_;
};

}  // namespace pcl_slim::detail

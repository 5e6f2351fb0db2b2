// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Detail below the noise": the variance that neighbouring residuals share.
#pragma once

#include <vector>

#include "radius/radius_constants.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief Tells a surface's unresolved detail from noise by what neighbouring residuals share.
 *
 * Noise differs from point to point; detail that a fit misses is common to points that lie close
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
   * cell; 0: as the points' density has it. \param[in] correlation points that share their noise.
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

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim {

/** \brief How sure the blended surface is at a place: standard errors of what is read from it.
 *
 * Of each quantity x the variance is (sum g s / sum g)^2 + sum g^2 (x_k - x)^2 / (sum g)^2 over the
 * leaves k there with weights g. The first term is what noise does: s is the standard error of a
 * leaf's x_k by its normal equations, and the leaves of one place share their points, so that
 * their errors add up as if they were one. The second term is how far the leaves disagree, which
 * is what their polynomials cannot follow. Errors count only as far as the points show them:
 * neither an error of registration nor detail finer than the noise lets a fit see is in them
 * (docs/theory.md, "Standard errors"). */
struct StandardErrors {
  float position = 0;   ///< along the normal, units of length; 95 % within 1.96 of these
  float normal = 0;     ///< RMS angle [rad]; 95 % within 1.73 of these, as it has two components
  float curvature = 0;  ///< of the mean curvature, 1/length; 0 where no curvature was requested
};

}  // namespace pcl_slim

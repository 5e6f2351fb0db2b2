// SPDX-License-Identifier: BSD-3-Clause
// What noise does to one leaf (docs/theory.md, "Standard errors"): the variances of its height, its
// slope and its bend at (u, v) are polynomials, by the normal equations of the fit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Variances of a leaf in units of its own noise: over the effective number of points.
 *
 * Each is a polynomial in u and v, stored for Horner's rule: powers of u descend, and within each
 * those of v. That of a leaf whose points are all around is a polynomial in u^2 + v^2 alone. */
struct ErrorPolynomials {
  std::vector<float> height;  ///< of h: degree 2D in u and v
  std::vector<float> slope;   ///< of h_u and h_v together: degree 2D - 2
  std::vector<float> bend;    ///< of h_uu + h_vv: degree 2D - 4; empty for planes
};

/** \brief The errors of a leaf as kernels read them. */
struct LeafErrors {
  float deviation = 0;  ///< of a height whose variance is 1 in the polynomials [radii]
  bool round = true;    ///< the polynomials are those in u^2 + v^2
  const ErrorPolynomials* variances = nullptr;
};

/** \brief The errors of all leaves of a surface.
 *
 * Weighted least squares of heights with noise of variance v gives coefficients of covariance v
 * A^-1 B A^-1, A = sum w m m^T, B = sum w^2 m m^T for the monomials m. The sums over points are
 * integrals over the part of the disc that the leaf's trim map has data in, as if points were
 * evenly spread there; n_eff, which the surface stores, is their number. Per leaf v = e^2 + lambda
 * min(1, tau P / n_eff), its own residuals and what the fit followed of the noise; tau points that
 * share an error count as one. O(leaves), and for open ones some 20 us each; the same for any
 * number of threads. */
class LeafErrorTable {
 public:
  LeafErrorTable() = default;
  LeafErrorTable(const SLIMSurface& surface, int threads);

  /** \brief The errors of surfel i, a leaf; valid while this table is. */
  LeafErrors of(const SLIMSurface& surface, std::uint32_t i) const;

 private:
  const ErrorPolynomials& round(const SLIMSurface& surface, std::uint32_t i) const;

  /// by degree, of balls by the fit's kernel and of those at the minimum support
  std::array<std::array<ErrorPolynomials, 2>, kMaxDegree + 1> round_;
  std::vector<ErrorPolynomials> open_;  ///< of leaves with trim maps
  std::vector<std::uint32_t> at_;       ///< place in open_ of each surfel; empty: none is open
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

constexpr int kMaxDegree = 4;
constexpr int kMaxCoefficients = 15;
constexpr float kMostCoefficient = 0x1p30f;  ///< largest of a polynomial in the unit ball

/** \brief Number of coefficients of a bivariate polynomial of the given degree: 3, 6, 10, 15. */
constexpr int numCoefficients(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

/** \brief Orthonormal frame whose w axis is a unit normal; u and v are a fixed function of it.
 *
 * Branch-free construction after Duff et al. 2017. Turning the normal round keeps u and turns v,
 * so that a surfel's frame needs no storage and its orientation can be changed exactly.
 */
struct PCL_SLIM_EXPORT LocalFrame {
  std::array<double, 3> u, v, w;

  LocalFrame() = default;
  explicit LocalFrame(const std::array<double, 3>& normal);
};

/** \brief Derivatives up to order three of f at a point, in the frame's axes.
 *
 * h is the height polynomial: f = w - h(u, v), so grad f = (-h_u, -h_v, 1) and every higher
 * derivative of f is minus that of h.
 */
struct HeightJet {
  double h = 0, hu = 0, hv = 0, huu = 0, huv = 0, hvv = 0;
  double huuu = 0, huuv = 0, huvv = 0, hvvv = 0;
};

/** \brief Height h(u, v) of a local polynomial in units where the ball has radius 1.
 *
 * Coefficients are in order of degree: 1; u, v; u^2, uv, v^2; u^3, u^2 v, u v^2, v^3; u^4 ...
 * so those of a lower degree are a prefix. \param[in] c numCoefficients(degree) values.
 */
PCL_SLIM_EXPORT double evaluateHeight(int degree, const float* c, double u, double v);

/** \brief h with its derivatives up to order three (those above the degree are 0). */
PCL_SLIM_EXPORT HeightJet evaluateJet(int degree, const float* c, double u, double v);

/** \brief Rewrites coefficients for the frame of the opposite normal; f changes sign. */
PCL_SLIM_EXPORT void flipCoefficients(int degree, float* c);

}  // namespace pcl_slim

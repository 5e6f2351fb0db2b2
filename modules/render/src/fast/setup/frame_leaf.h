// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/surface/detail/trim_tables.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

/** \brief A surfel as one frame's rays meet it, in coordinates of its own; set up once a frame.
 *
 * Let z_c be the depth of the centre, X and Y the offset of a ray from it at that depth and
 * s = (z - z_c) / r, all in radii. With eps = r / z_c (0 if parallel) and sigma = s / (1 + eps s)
 * a ray's point is, in radii from the centre and in the camera's axes,
 *     (X + x_c sigma, Y + y_c sigma, sigma) / m,    m = 1 - eps sigma,
 * so that F = m^n f / r, n the degree, is a polynomial of degree n in X, Y and sigma together. Its
 * coefficients follow the record: sum_i sigma^i A_i(X, Y) with A_i of degree n - i, A_0 first, each
 * in the order of height polynomials. Then follow, of a quadratic, the second derivatives of f
 * (camera's axes, Symmetric3's order), else the polynomials h_u, h_v, h_uu, h_uv, h_vv in that order.
 */
struct FrameLeaf {
  float x, y;       ///< pixel of the centre
  float per_pixel;  ///< change of X by a pixel
  float eps, xc, yc;
  float depth, inverse_depth;  ///< z_c and its reciprocal (1 if parallel)
  float radius, inverse_radius;
  float beta, inverse_beta;  ///< d sigma / dD
  float nearest;             ///< no ray meets the ball at a depth value below
  float variance_weight;
  float u[3], v[3], w[3];               ///< the surfel's frame in the camera's axes
  float uc, vc;                         ///< u . (x_c, y_c, 1) and v . (x_c, y_c, 1)
  float blend_x, blend_y, blend_reach;  ///< pixels: a circle around the ball's picture
  float first_x, first_y, first_reach;  ///< the same of the ball of pass 1
  float strip_x, strip_y;               ///< a direction in the picture, and between which
  float strip_low, strip_high;  ///< pixels from the centre: the surface in that ball is within
  float inverse_cover_sq;       ///< of the radius in which it covers; 0: wherever it counts
  std::uint32_t surfel;
  std::uint16_t degree;  ///< of the polynomials here, 2 to 4; kNearLeaf: none, too near

  TrimTable trim;    ///< where the surfel has data
  float trim_scale;  ///< of the ball here, in the surfel's radii, which its trim map counts in

  const float* form() const { return reinterpret_cast<const float*>(this + 1); }
  float* form() { return reinterpret_cast<float*>(this + 1); }
  const float* derivatives() const { return form() + formSize(degree); }

  /** \brief Coefficients of F: 10, 20, 35 for degree 2, 3, 4. */
  static constexpr int formSize(int n) { return (n + 1) * (n + 2) * (n + 3) / 6; }
  /** \brief Floats of the derivatives. */
  static constexpr int derivativeSize(int n)
  {
    return n == 2 ? 6 : 2 * numCoefficients(n - 1) + 3 * numCoefficients(n - 2);
  }
};

constexpr std::uint16_t kNearLeaf = 0;

/** \brief Bytes from one record to the next for surfels of a degree: whole cache lines. */
constexpr std::size_t
leafStride(int degree)
{
  const int floats = FrameLeaf::formSize(degree) + FrameLeaf::derivativeSize(degree);
  const std::size_t bytes = sizeof(FrameLeaf) + sizeof(float) * static_cast<std::size_t>(floats);
  return (bytes + 63) / 64 * 64;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/surface/surfel_color.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief Red, green and blue of all stored points, padding included. */
using ColorColumns = std::array<AlignedVector<std::uint8_t>, 3>;

/** \brief A surfel as its colours see it: points of the ball within its normal bound, and near its
 * polynomial. */
struct ColorBall {
  BallQuery ball;
  LocalFrame frame;
  int degree;
  const float* c;      ///< coefficients in units of the radius
  float max_residual;  ///< [radii]; infinite: no point is too far
};

/** \brief Sums of the normal equations of a polynomial in (u, v) for each channel. */
struct ColorSums {
  static constexpr int kMoments = numCoefficients(2 * kColorDegree);
  std::array<double, kMoments> moments{};  ///< sum w u^i v^j, in the order of evaluateHeight()
  std::array<std::array<double, kColorTerms>, 3> channels{};  ///< sum w colour u^i v^j
  double weight_sq = 0;
};

namespace kernels {

/** \brief Sums over the points of some blocks inside a surfel's ball, weighted by a kernel. */
ColorSums
sumColors(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
          WeightKernel kernel, const ColorColumns& colors);

}  // namespace kernels
}  // namespace pcl_slim::detail

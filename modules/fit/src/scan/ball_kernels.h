// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim::detail {

/** \brief The points of one ball as columns, padded with weightless entries to whole vectors.
 *
 * After gathering: offsets from the centre in local units and their squared length; normals where
 * they are data. After toFrame(): frame coordinates and squared distance in units of the gather
 * radius; the slopes from the normals.
 */
struct BallBuffer {
  AlignedVector<float> u, v, w, s_sq;
  AlignedVector<float> n_u, n_v, n_w;  ///< normals; in the frame slopes n_u, n_v and weights n_w
  AlignedVector<float> prior;          ///< robust weights; empty: all 1
  double slope_weight = 0;  ///< of slopes relative to heights, in the frame's units; 0: no slopes
  std::size_t count = 0;

  static constexpr std::size_t kPadding = 64;

  void reserve(std::size_t capacity) {
    if (u.size() >= capacity + kPadding) return;
    const std::size_t grown = capacity + capacity / 8 + kPadding;  // wide balls: millions
    for (auto* column : {&u, &v, &w, &s_sq}) column->resize(grown);
  }

  /** \brief Room for normals as well; call after reserve(). */
  void reserveNormals() {
    for (auto* column : {&n_u, &n_v, &n_w}) column->resize(std::max(column->size(), u.size()));
  }
};

/** \brief A ball of stored points: its place, and the normal bound that keeps other sheets out. */
struct BallQuery {
  std::array<float, 3> center;
  float radius;
  const float* bound_normal = nullptr;  ///< null: every point counts
  float min_dot = 0.0f;                 ///< points need normal . bound_normal > min_dot
  bool take_normals = false;            ///< gather the normals too
};

/** \brief Sums over a gathered ball, weighted by (1 - s^2)^4. */
struct BallSums {
  std::size_t inside = 0;  ///< points in the ball, within the normal bound or not
  double weight = 0;
  std::array<double, 3> normal{};  ///< weighted sum of normals (zero without normals)
  std::array<double, 3> first{};   ///< weighted sum of offsets
  std::array<double, 6> second{};  ///< of products xx, xy, xz, yy, yz, zz
};

/** \brief SIMD inner loops of the fit, compiled per instruction set and chosen at run time. */
namespace kernels {

/** \brief Gathers a ball's points within its normal bound from the given blocks (ascending). */
void gatherBall(const PointStore& store, const BlockList& blocks, const BallQuery& query,
                bool with_covariance, BallBuffer& ball, BallSums& sums);

/** \brief Turns offsets into frame coordinates in units of radius, and normals into slopes if
 * ball.slope_weight is not 0. */
void toFrame(const LocalFrame& frame, float radius, BallBuffer& ball);

/** \brief Copies the points with s_sq below a limit. */
void compactBall(const BallBuffer& ball, float limit_sq, BallBuffer& inner);

/** \brief Copies the points whose residual is in [low, high]. */
void selectResiduals(const BallBuffer& ball, const float* residuals, float low, float high,
                     BallBuffer& kept);

/** \brief Residuals w - h(u, v), padding included. \param[in] c coefficients of h in the ball's
 * units
 * \param[out] residuals count rounded up. */
void ballResiduals(const BallBuffer& ball, int degree, const double* c, float* residuals);

/** \brief A leaf as the cover sees it. */
struct CoverLeaf {
  BallQuery ball;  ///< radius R = alpha r
  LocalFrame frame;
  int degree;
  float support_radius;  ///< r
  const float* c;        ///< coefficients in units of r
  float max_residual;    ///< points farther from f = 0 are not covered
  bool to_foot = false;  ///< distances count to a point's foot on f = 0, not to the point itself
};

/** \brief Adds G(d / R) to the coverage of the points a leaf covers; touches no other. */
void coverPoints(const PointStore& store, const BlockList& blocks, const CoverLeaf& leaf,
                 WeightKernel kernel, float* coverage);

/** \brief Sets the bits of value in the marks of a ball's points within its normal bound; touches
 * no other. */
void markPoints(const PointStore& store, const BlockList& blocks, const BallQuery& ball,
                std::uint8_t value, std::uint8_t* marks);

}  // namespace kernels
}  // namespace pcl_slim::detail

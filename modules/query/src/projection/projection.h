// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/surface/detail/trim_tables.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surfel_texture.h"
#include "pcl_slim/surface/weight_kernel.h"
#include "projection/error_polynomials.h"

namespace pcl_slim::detail {

/** \brief A leaf as projection sees it, relative to one block of points. */
struct BlockLeaf {
  float shift[3];          ///< block origin minus the leaf's centre
  float u[3], v[3], w[3];  ///< frame axes
  float radius;
  float max_residual;     ///< in units of the radius: points farther from f = 0 do not count
  float max_offset;       ///< in units of the radius: roots farther along the ray do not count
  float variance_weight;  ///< inverse-variance weight, in (0, 1]
  int degree;
  const float* c;
  TrimTable trim;                       ///< where the leaf has data
  const std::uint8_t* color = nullptr;  ///< kColorBytes, or none
  SurfelTexture texture;                ///< in place of them, or empty
  bool textured = false;                ///< some leaf of the surface has a texture
  LeafErrors errors;                    ///< or none
};

/** \brief A block's 16 points: offsets from its origin, and normals where they are to decide. */
struct BlockPoints {
  const float *x, *y, *z;
  const float *nx = nullptr, *ny = nullptr, *nz = nullptr;
  float min_dot = 0.0f;  ///< a leaf counts at a point if their normals' cosine is above this
};

/** \brief Sums over the leaves of a block's 16 points; columns per point. */
struct BlockSums {
  alignas(64) float direction[3][16];  ///< sum w n of pass 1, then the unit ray direction
  alignas(64) float weight[16];        ///< of pass 1: sum +-w, if leaves need alignment; then sum w
  alignas(64) float offset[16];        ///< sum w t
  alignas(64) float outside[16];       ///< sum w outside: of the trim maps, see outsideShare
  alignas(64) float gradient[3][16];   ///< sum w grad f
  alignas(64) float hessian[6][16];    ///< sum w H, entries as in Symmetric3
  alignas(64) float third[10][16];     ///< sum w T: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz
};

/** \brief One leaf under a block's points, in its own frame and units: what pass 1 keeps for pass 2
 * of the points in its ball. */
struct LeafHeights {
  alignas(64) float place[3][16];
  alignas(64) float height[3][16];  ///< of the polynomial, and its slopes
};

/** \brief How leaves meet points. */
struct BlendRules {
  WeightKernel kernel = WeightKernel::kPower4;
  bool oriented = false;  ///< normals agree; otherwise signs are aligned point by point
  bool guarded = true;  ///< weight at the larger of |p - c| and |q - c|; residual and t have limits
  bool with_hessian = false;
  bool with_third = false;  ///< third derivatives too; needs with_hessian
};

namespace kernels {

/** \brief Pass 1: adds a leaf's normals, in the points' frame, to the ray directions. */
void addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                   BlockSums& sums, LeafHeights& heights);

/** \brief Makes the directions unit and clears the sums of pass 2; zero where nothing was added. */
void finishDirections(BlockSums& sums);

/** \brief Pass 2: meets the rays p + t d with a leaf and adds what equations (6)-(8) blend.
 * \param[in] heights as pass 1 left them. */
void addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                      const LeafHeights& heights, BlockSums& sums);

}  // namespace kernels

/** \brief A leaf's frame, polynomial and gates, in the surface's local units; its shift, weight and
 * trim map are left to the caller.
 * \param[in] residual the largest that counts [r] \param[in] noise deviation, local units */
BlockLeaf blockLeaf(const SLIMSurface& surface, std::uint32_t i, double residual, double noise);

/** \brief Mean and Gaussian curvature of a level set (eq. 8, left).
 * \param[in] g gradient, longer than kLeastGradient; \param[in] h Hessian.
 * Positive where the surface bends away from g. */
std::array<float, 2> meanAndGaussian(const Vector3& g, const Symmetric3<double>& h);

/** \brief Eigenvalues and eigenvectors of the same level set's shape operator. \param[in] length of
 * the gradient */
PrincipalFrame principalCurvatures(const Vector3& g, double length, const Symmetric3<double>& h);

/** \brief Fills in dk/dt along each principal direction t: (T(t,t,t) - 3 k H(t,n)) / |g|.
 * \param[in] third third derivatives: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz. */
void setExtremality(const Vector3& g, double length, const Symmetric3<double>& h,
                    const double third[10], PrincipalFrame& principal);

}  // namespace pcl_slim::detail

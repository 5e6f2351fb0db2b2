// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Standard errors of a block's sixteen points, in a third pass over its leaves.
#include "pcl_slim/query/standard_errors.h"
#include "projection/projection.h"

namespace pcl_slim::detail {

/** \brief What was blended for a block's 16 points: the means that leaves are compared with. */
struct BlockBlend {
  alignas(64) float offset[16];     ///< along the ray
  alignas(64) float normal[3][16];  ///< unit
  alignas(64) float curvature[16];  ///< mean
};

/** \brief Sums over the leaves of a block's 16 points: noise is sum w s, spread is sum w^2 (x -
 * mean)^2. */
struct BlockErrors {
  alignas(64) float weight[16];
  alignas(64) float noise[3][16];  ///< of position, normal, curvature
  alignas(64) float spread[3][16];
};

namespace kernels {

/** \brief Pass 3: adds the standard errors of a leaf that has them, and its deviations from what was
 * blended.
 * \param[in] heights as pass 1, \param[in] sums as passes 1 and 2 left them. */
void addErrors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const LeafHeights& heights, const BlockSums& sums, const BlockBlend& blend,
               BlockErrors& block);

}  // namespace kernels

/** \brief The standard errors of point i of a block; zero where no leaf counts. */
StandardErrors standardErrors(const BlockErrors& block, std::size_t i, bool with_curvature);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "camera/camera_rays.h"
#include "fast/setup/frame_leaf.h"
#include "index/leaf_index.h"

namespace pcl_slim::detail {

/** \brief Radii in which a frame looks at its leaves, as shares of the balls'. */
struct BallShares {
  float first;  ///< alpha of pass 1
  float blend;  ///< beyond, a leaf's weight does not count
};

/** \brief Surfels of one degree, as columns, to be set up side by side. */
struct LeafBatch {
  static constexpr std::size_t kSize = 16;

  alignas(64) float x[kSize], y[kSize], z[kSize], radius[kSize];
  alignas(64) float nx[kSize], ny[kSize], nz[kSize], variance_weight[kSize];
  alignas(64) float c[kMaxCoefficients][kSize];
  float inverse_cover_sq[kSize];
  std::uint32_t surfel[kSize];
  FrameLeaf* target[kSize];
  std::size_t count = 0;
};

namespace kernels {

/** \brief What is seen of one cluster's surfels. Errs on the visible side.
 * \param[out] visibility by surfel
 * \param[out] shares of the weight, above 0 of every visible one; room for whole vectors */
void
cullLeaves(const LeafIndex& index, std::uint32_t begin, std::uint32_t end, const FrameView& view,
           const VisibilityRules& rules, Visibility* visibility, float* shares);

/** \brief Writes the frame's records of a batch. Surfels too near to the camera for a polynomial
 * along its rays get kNearLeaf. \param[in] degree 2 to 4; missing coefficients are 0 */
void
setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view, const BallShares& shares);

}  // namespace kernels
}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "camera/camera_rays.h"
#include "fast/setup/frame_leaf.h"
#include "fast/setup/leaf_clusters.h"
#include "pcl_slim/surface/surface.h"

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

/** \brief Visibility of one cluster's surfels. Errs on the visible side.
 * \param[out] visibility by surfel
 * \param[out] shares of the weight, above 0 of every visible one; room for whole vectors */
void
cullLeaves(const LeafClusters& leaves, std::uint32_t begin, std::uint32_t end,
           const FrameView& view, const VisibilityRules& rules, Visibility* visibility,
           float* shares);

/** \brief Writes the frame's records of a batch. Surfels too near to the camera for a polynomial
 * along its rays get kNearLeaf. \param[in] degree 2 to 4; missing coefficients are 0 */
void
setUpLeaves(const LeafBatch& batch, int degree, const FrameView& view, const BallShares& shares);

}  // namespace kernels

/** \brief How large a surfel's ball is taken, and in what share of it the surfel covers. */
struct BallShape {
  float scale = 1.0f;
  float inverse_cover_sq = 0.0f;  ///< 0: wherever it counts
};

/** \brief Surfels sorted into batches of one degree, set up as they fill. */
class BatchFiller {
 public:
  BatchFiller(const SLIMSurface& surface, const FrameView& view, const BallShares& shares)
      : surface_(surface), view_(view), shares_(shares)
  {
  }

  /** \param[in] weight factor of its blending weight */
  void add(std::uint32_t s, float weight, const BallShape& shape, FrameLeaf* target)
  {
    const int degree = std::max<int>(2, surface_.degree[s]);
    LeafBatch& batch = batches_[degree - 2];
    const std::size_t lane = batch.count++;
    batch.x[lane] = surface_.cx[s];
    batch.y[lane] = surface_.cy[s];
    batch.z[lane] = surface_.cz[s];
    batch.radius[lane] = shape.scale * surface_.radius[s];
    batch.nx[lane] = surface_.nx[s];
    batch.ny[lane] = surface_.ny[s];
    batch.nz[lane] = surface_.nz[s];
    batch.variance_weight[lane] = weight;
    batch.inverse_cover_sq[lane] = shape.inverse_cover_sq;
    batch.surfel[lane] = s;
    batch.target[lane] = target;
    const float* c = surface_.coefficientsOf(s);
    const int known = numCoefficients(surface_.degree[s]), all = numCoefficients(degree);
    float power = 1.0f / shape.scale;  // of a radius that large, at height 0
    for (int n = 0, k = 0; k < all; ++n, power *= shape.scale) {
      for (int j = 0; j <= n; ++j, ++k) batch.c[k][lane] = k < known ? power * c[k] : 0.0f;
    }
    if (batch.count == LeafBatch::kSize) flush(degree);
  }

  void flushAll()
  {
    for (int degree = 2; degree <= kMaxDegree; ++degree) flush(degree);
  }

 private:
  void flush(int degree)
  {
    LeafBatch& batch = batches_[degree - 2];
    if (batch.count == 0) return;
    // Lanes to spare repeat the first one: any surfel will do, but numbers must be there.
    for (std::size_t lane = batch.count; lane < LeafBatch::kSize; ++lane) {
      for (float* column : {batch.x, batch.y, batch.z, batch.radius, batch.nx, batch.ny, batch.nz,
                            batch.variance_weight}) {
        column[lane] = column[0];
      }
      for (int k = 0; k < numCoefficients(degree); ++k) batch.c[k][lane] = batch.c[k][0];
    }
    kernels::setUpLeaves(batch, degree, view_, shares_);
    batch.count = 0;
  }

  const SLIMSurface& surface_;
  const FrameView& view_;
  const BallShares& shares_;
  LeafBatch batches_[3];
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "fast/leaf_setup.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Surfels sorted into batches of one degree, set up as they fill. */
class BatchFiller {
 public:
  BatchFiller(const SLIMSurface& surface, const FrameView& view, const BallShares& shares)
      : surface_(surface), view_(view), shares_(shares)
  {
  }

  /** \param[in] weight factor of its blending weight */
  void add(std::uint32_t s, float weight, FrameLeaf* target)
  {
    const int degree = std::max<int>(2, surface_.degree[s]);
    LeafBatch& batch = batches_[degree - 2];
    const std::size_t lane = batch.count++;
    batch.x[lane] = surface_.cx[s];
    batch.y[lane] = surface_.cy[s];
    batch.z[lane] = surface_.cz[s];
    batch.radius[lane] = surface_.radius[s];
    batch.nx[lane] = surface_.nx[s];
    batch.ny[lane] = surface_.ny[s];
    batch.nz[lane] = surface_.nz[s];
    batch.variance_weight[lane] = weight;
    batch.surfel[lane] = s;
    batch.target[lane] = target;
    const float* c = surface_.coefficientsOf(s);
    const int known = numCoefficients(surface_.degree[s]), all = numCoefficients(degree);
    for (int k = 0; k < all; ++k) batch.c[k][lane] = k < known ? c[k] : 0.0f;
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

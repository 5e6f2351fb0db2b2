// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/surface/surface.h"
#include "rays/wide_tree.h"

namespace pcl_slim::detail {

/** \brief Columns of a block of leaves, kWide values each; the coefficients follow. */
enum LeafColumn : std::size_t {
  kBlockX,  ///< centres less the block's
  kBlockY,
  kBlockZ,
  kBlockRadius,
  kBlockInverseRadius,
  kBlockNX,
  kBlockNY,
  kBlockNZ,
  kBlockVariance,  ///< inverse-variance weight
  kBlockCoefficients,
};

/** \brief Leaves of a surface in blocks of eight, columns side by side, for vector lanes.
 *
 * Centres count from a point of each block's own, so that single precision is as fine as the leaves.
 * Lanes without a leaf contain a ball that no ray meets.
 */
class LeafBlocks {
 public:
  LeafBlocks() = default;
  /** \param[in] order of leaves, as WideTree::order: places in leaves */
  LeafBlocks(const SLIMSurface& surface, const std::vector<std::uint32_t>& leaves,
             const std::vector<std::uint32_t>& order);

  /** \brief What all lanes of a block share. */
  struct Head {
    float center[3];
    int degree;  ///< the highest of the block's leaves
    std::uint32_t surfel[kWide];
  };

  const Head& head(std::size_t block) const { return heads_[block]; }
  /** \brief The columns of a block, one after the other. */
  const float* columns(std::size_t block) const { return columns_.data() + block * stride_; }

 private:
  void fill(const SLIMSurface& surface, const std::uint32_t* surfels, std::size_t block);

  std::size_t stride_ = 0;
  AlignedVector<Head> heads_;
  AlignedVector<float> columns_;
};

/** \brief The box of a leaf's surface where it is inside the ball of a share of its radius, at
 * most slack radii off the surface. */
Box
boxOfLeaf(const SLIMSurface& surface, std::size_t i, double share, double slack);

}  // namespace pcl_slim::detail

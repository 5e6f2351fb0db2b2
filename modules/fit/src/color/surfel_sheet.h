// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/surface/surface.h"
#include "scan/ball_kernels.h"
#include "trim/trim.h"

namespace pcl_slim::detail {

/** \brief Which stored points are a surfel's. */
struct SheetBounds {
  float reach = 1;         ///< [radii] of the ball
  bool facing = false;     ///< those alone whose side is the surfel's
  float max_residual = 0;  ///< [radii] distance from its polynomial
  /// of the ball, chosen evenly: the approximate limit of their number
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

/** \brief Blocks of points that meet a ball: all, or every n-th, so that they have about a number of
 * points at most. */
inline void listBlocks(const PointStore& store, const float center[3], float radius,
                       std::size_t most, std::vector<std::uint32_t>& found, BlockList& blocks) {
  found.clear();
  blocks.clear();
  store.tree().blocksInBall(center, radius, found);
  const std::size_t step = 1 + found.size() / (most / PointStore::kBlock + 1);
  for (std::size_t b = 0; b < found.size(); b += step) blocks.push_back(found[b]);
}

/** \brief Collects the points of one surfel's sheet after another. One per thread: it keeps its
 * memory. */
class SurfelSheet {
 public:
  const SheetPoints& gather(const PointStore& store, const SLIMSurface& s, std::size_t i,
                            const SheetBounds& bounds) {
    const std::array<float, 3> normal{s.nx[i], s.ny[i], s.nz[i]};
    kernels::CoverLeaf leaf;
    leaf.ball = {{s.cx[i], s.cy[i], s.cz[i]}, bounds.reach * s.radius[i]};
    if (bounds.facing) leaf.ball.bound_normal = normal.data();
    leaf.frame = LocalFrame({s.nx[i], s.ny[i], s.nz[i]});
    leaf.degree = s.degree[i];
    leaf.support_radius = s.radius[i];
    leaf.c = s.coefficientsOf(i);
    leaf.max_residual = bounds.max_residual * s.radius[i];
    listBlocks(store, leaf.ball.center.data(), leaf.ball.radius, bounds.most, found_, blocks_);
    kernels::gatherSheet(store, blocks_, leaf, points_);
    return points_;
  }

 private:
  std::vector<std::uint32_t> found_;
  BlockList blocks_;
  SheetPoints points_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim::detail {

/** Discs in a store's coordinates under a tree of boxes. */
class DiscTree {
 public:
  /** depth: how far above or below a place, beyond its radius, a disc may be met; least_cosine: of
   * the most that rays lean. */
  DiscTree(const PointStore& store, const SplatSet& splats, double depth, double least_cosine);

  /** Discs that a ray meets near a place. cosine: of its lean; near: room to work in. */
  std::uint32_t count(const Eigen::Vector3d& place, const Eigen::Vector3d& direction, double cosine,
                      std::vector<std::uint32_t>& near) const;

 private:
  /** The box of a disc. */
  void setBox(std::size_t i, double least_cosine, BlockTree::Level& boxes) const;

  std::vector<Eigen::Vector3d> center_, normal_;
  std::vector<double> radius_;
  double depth_;
  BlockTree tree_;
};

}  // namespace pcl_slim::detail

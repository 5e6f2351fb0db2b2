// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fast/frame_view.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

constexpr std::uint32_t kClusterSize = 64;  ///< leaves looked at together

/** \brief Neighbouring leaves: a sphere around their balls and a cone around their gradients. */
struct LeafNode {
  float center[3];
  float radius;
  float axis[3];
  float cone;  ///< half angle in radians; pi and more: the gradients have no side in common
  std::uint32_t begin, end;  ///< leaves, in the index's order
};

/** \brief Whether a ball or node may be seen. */
enum class Visibility : std::uint8_t { kVisible, kOutside, kBackFacing };

/** \brief A surface's leaves along a space-filling curve, under a tree of spheres and cones.
 *
 * Leaf columns are padded to whole clusters. Built once per surface: O(leaves log leaves).
 */
class LeafIndex {
 public:
  LeafIndex(const SLIMSurface& surface, int threads);

  std::size_t size() const { return surfel.size(); }

  /** \brief Appends the clusters that may be seen, in order, and counts the leaves of the others.
   * \param[in] front_only leave out what is turned away as well */
  void findVisible(const FrameView& view, bool front_only, std::vector<std::uint32_t>& clusters,
                   std::uint64_t& outside, std::uint64_t& back_facing) const;

  const LeafNode& cluster(std::uint32_t c) const { return levels_.front()[c]; }
  std::size_t numClusters() const { return levels_.empty() ? 0 : levels_.front().size(); }

  std::vector<std::uint32_t> surfel;     ///< of the surface
  AlignedVector<float> x, y, z, radius;  ///< the ball
  AlignedVector<float> nx, ny, nz;       ///< the normal
  AlignedVector<float> sine;  ///< of the largest angle between normal and gradient in the ball
  AlignedVector<float> variance_weight;

 private:
  void sortLeaves(const SLIMSurface& surface, int threads);
  void fillColumns(const SLIMSurface& surface);
  LeafNode enclose(std::uint32_t begin, std::uint32_t end) const;

  std::vector<std::vector<LeafNode>> levels_;  ///< clusters first, each level 8 of the one before
};

/** \brief Whether a ball whose gradients lie in a cone may be seen. Errs on the visible side. */
Visibility
visibilityOf(const FrameView& view, const LeafNode& node, bool front_only);

/** \brief An upper bound on |grad h| over the unit ball, from the coefficients' absolute values. */
double
slopeBound(const SLIMSurface& surface, std::size_t i);

}  // namespace pcl_slim::detail

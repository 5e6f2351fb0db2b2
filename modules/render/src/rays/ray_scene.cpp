// SPDX-License-Identifier: BSD-3-Clause
#include "rays/ray_scene.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {

RayScene::RayScene(const SLIMSurface& s, int threads)
    : surface(s),
      shrink(std::clamp(s.info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(s.info.cover_radius, 0.05, 1.0))
{
  constexpr double kMaxShift = 0.25;  // as in blendLeaf()
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<Box> hit(leaves.size()), reach(leaves.size());
  parallelFor(leaves.size(), threads, 1024, [&](std::size_t i, int) {
    hit[i] = boxOfLeaf(surface, leaves[i], shrink, 0.0);
    reach[i] = boxOfLeaf(surface, leaves[i], 1.0, kMaxShift);
  });
  tree = buildWideTree(hit, reach, threads);
  blocks = LeafBlocks(surface, leaves, tree.order);
}

RayCounts&
RayCounts::operator+=(const RayCounts& other)
{
  nodes += other.nodes;
  leaves_first += other.leaves_first;
  leaves_blend += other.leaves_blend;
  bracketed += other.bracketed;
  peeled += other.peeled;
  return *this;
}

}  // namespace pcl_slim::detail

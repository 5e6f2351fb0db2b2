// SPDX-License-Identifier: BSD-3-Clause
#include "rays/ray_scene.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {

RayScene::RayScene(const SLIMSurface& s, int threads)
    : surface(s),
      shrink(std::clamp(s.info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(s.info.cover_radius, 0.05, 1.0))
{
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<Box> hit(leaves.size()), reach(leaves.size());
  parallelFor(leaves.size(), threads, 1024, [&](std::size_t i, int) {
    hit[i] = boxOfLeaf(surface, leaves[i], shrink, 0.0);
    reach[i] = boxOfLeaf(surface, leaves[i], 1.0, kMaxShift);
  });
  tree = buildWideTree(hit, reach, threads);
  blocks = LeafBlocks(surface, leaves, tree.order);
}

bool
closesGap(const BlendSum& sum, const Vector3& direction)
{
  // In the rim of balls weights fall steeply, so that the nearest leaf outweighs all others: leaves count
  // alike here. At the rim of a sheet they are on one side, .5 radii away and more in the mean.
  constexpr double kMaxSpread = 0.3, kAgreement = 0.8, kLeastCosine = 0.4;
  constexpr int kLeastLeaves = 3;
  if (isOutside(sum)) return false;
  const Vector3 gradient{sum.gradient[0], sum.gradient[1], sum.gradient[2]};
  const Vector3 lean{sum.spread[0], sum.spread[1], sum.spread[2]};
  const double size = length(gradient);
  return sum.leaves >= kLeastLeaves && length(lean) < kMaxSpread * sum.leaves &&
         size > kAgreement * sum.weight && std::abs(dot(gradient, direction)) > kLeastCosine * size;
}

RayCounts&
RayCounts::operator+=(const RayCounts& other)
{
  nodes += other.nodes;
  leaves_first += other.leaves_first;
  leaves_blend += other.leaves_blend;
  bracketed += other.bracketed;
  closed += other.closed;
  peeled += other.peeled;
  return *this;
}

}  // namespace pcl_slim::detail

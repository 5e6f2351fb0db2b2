// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/surface/surface.h"
#include "rays/leaf_blocks.h"
#include "rays/wide_tree.h"
#include "reference/leaf_on_ray.h"

namespace pcl_slim::detail {

/** \brief A surface's leaves under a tree, as rays meet them; local units. */
struct RayScene {
  const SLIMSurface& surface;
  WideTree tree;
  LeafBlocks blocks;
  double shrink;        ///< share of the radius within which leaves are met first
  double cover_radius;  ///< alpha of the coverage measure

  RayScene(const SLIMSurface& surface, int threads);
};

/** \brief How rays meet leaves. */
struct RayRules {
  bool front_only = false;    ///< first roots and blends: only where the gradient faces the ray
  bool with_hessian = false;  ///< blend second derivatives too
  bool close_gaps = false;    ///< look beyond shrunk balls where a ray meets nothing in them
  double min_coverage = 0.1;  ///< where it is less, the surface is not defined
};

/** \brief A ray and the stretch of it that counts. */
struct BoundedRay {
  Ray ray;
  double nearest = 0.0;         ///< first roots come no nearer
  double nearest_front = 0.0;   ///< the same of those met from the front ...
  double nearest_behind = 0.0;  ///< ... and from behind
  double nearest_gap = 0.0;     ///< gaps between shrunk balls come no nearer
  double farthest = HUGE_VAL;
};

/** \brief What a ray met first. */
struct BlendedHit {
  double depth_hat = HUGE_VAL;  ///< of q^; infinity where nothing was met
  BlendSum sum;

  bool met() const { return depth_hat < HUGE_VAL; }
};

/** \brief How much wider than a line a ray is: base + slope times the distance from its origin. */
struct RayWidth {
  float base = 0.0f, slope = 0.0f;
};

/** \brief Called for each block; farthest may be made smaller. \return false to stop. */
struct BlockVisitor {
  bool (*visit)(void* context, std::uint32_t block, double& farthest);
  void* context;
};

/** \brief What rays cost. */
struct RayCounts {
  std::uint64_t nodes = 0;         ///< nodes of the tree looked at
  std::uint64_t leaves_first = 0;  ///< polynomials restricted to a ray to find the first root
  std::uint64_t leaves_blend = 0;  ///< the same to blend
  std::uint64_t bracketed = 0;     ///< of both, those whose roots had to be isolated one by one
  std::uint64_t closed = 0;        ///< camera rays that met a gap between shrunk balls
  std::uint64_t peeled = 0;        ///< blends that did not belong to the surface

  RayCounts& operator+=(const RayCounts& other);
};

/** \brief Whether a blend outside of all shrunk balls closes a gap in a sheet: leaves are all around it,
 * point one way and face the ray. Across a slit they face each other, and at a silhouette they are on
 * one side and aslant. */
bool
closesGap(const BlendSum& sum, const Vector3& direction);

namespace kernels {

/** \brief The first place of each ray at which the blend of leaves belongs to the surface: q^ and
 * the sums there, as the reference rasteriser's in every rule but close_gaps. */
void
traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
          BlendedHit* hits, RayCounts& counts);

/** \brief Depths of the first roots inside shrunk balls alone, without a look at the blend there. */
void
traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays, std::size_t count,
            double* depths, RayCounts& counts);

/** \brief Whether the surface intersects the stretch of each ray: a root of a leaf at which
 * the blend belongs to the surface. front_only has no effect here. */
void
traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
             std::size_t count, std::uint8_t* blocked, RayCounts& counts);

/** \brief Visits the blocks whose widened box a ray meets, roughly from near to far. */
void
visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
            const BlockVisitor& visitor, std::uint64_t& nodes);

}  // namespace kernels
}  // namespace pcl_slim::detail

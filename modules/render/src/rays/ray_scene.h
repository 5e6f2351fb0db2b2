// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/surface/surface.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {

constexpr std::uint32_t kWide = 8;  ///< children of a node, and things in a block

/** \brief An axis-aligned box; empty until something is added. */
struct Box {
  float low[3] = {kFar, kFar, kFar};
  float high[3] = {-kFar, -kFar, -kFar};

  void add(const Box& other);
  /** \brief Half the surface area; 0 of an empty box. */
  double area() const;

  static constexpr float kFar = std::numeric_limits<float>::infinity();
};

/** \brief Boxes of a node's children side by side; row 2 a is low, row 2 a + 1 high along axis a.
 */
struct WideBoxes {
  alignas(64) float bound[6][kWide];
};

/** \brief A node's children: other nodes, or with kBlock set blocks, or kNoChild. */
struct WideNode {
  static constexpr std::uint32_t kBlock = 0x80000000u;
  static constexpr std::uint32_t kNoChild = 0xffffffffu;

  WideBoxes hit;  ///< what rays have to meet
  std::uint32_t child[kWide];
};

/** \brief A tree with eight children a node over boxes in blocks of eight, for one ray at a time.
 *
 * It is a tree apart from BlockTree, which groups neighbours along a Morton curve and so finds
 * blocks in ascending order: with such groups rays look at twice the nodes and take 1.4 times as
 * long.
 *
 * Each thing has two boxes: one in which rays meet it, and a wider one in which it takes part in a
 * blend. Node 0 is the root. Boxes are wider than given by more than the rounding of a ray in
 * single precision that starts no farther off than the tree is long.
 */
struct WideTree {
  AlignedVector<WideNode> nodes;
  AlignedVector<WideBoxes> reach;    ///< per node, the wider boxes of its children
  std::vector<std::uint32_t> order;  ///< kWide things a block; kNothing where there is none
  Box bounds;                        ///< of all boxes that rays have to meet

  static constexpr std::uint32_t kNothing = 0xffffffffu;

  std::size_t numBlocks() const { return order.size() / kWide; }
  bool empty() const { return nodes.empty(); }
};

/** \brief Builds the tree by the surface area heuristic in bins. O(n log n); the same for any
 * number of threads. \param[in] hit, reach finite boxes, one of each per thing */
WideTree buildWideTree(const std::vector<Box>& hit, const std::vector<Box>& reach, int threads);

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
 * Centres count from a point of each block's own, so that single precision is as fine as the
 * leaves. Lanes without a leaf contain a ball that no ray meets.
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
Box boxOfLeaf(const SLIMSurface& surface, std::size_t i, double share, double slack);

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
  bool enclosed = false;      ///< pixels about the rays met the surface: none passes above it
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

/** \brief Whether a blend outside of all shrunk balls closes a gap in a sheet: leaves are all
 * around it, point one way and face the ray. Across a slit they face each other, and at a
 * silhouette they are on one side and aslant. */
bool closesGap(const BlendSum& sum, const Vector3& direction);

namespace kernels {

/** \brief The first place of each ray at which the blend of leaves belongs to the surface: q^ and
 * the sums there, as the reference rasteriser's in every rule but close_gaps. */
void traceHits(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
               std::size_t count, BlendedHit* hits, RayCounts& counts);

/** \brief Depths of the first roots inside shrunk balls alone, without a look at the blend there.
 */
void traceDepths(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                 std::size_t count, double* depths, RayCounts& counts);

/** \brief Whether the surface intersects the stretch of each ray: a root of a leaf at which
 * the blend belongs to the surface. front_only has no effect here. */
void traceBlocked(const RayScene& scene, const RayRules& rules, const BoundedRay* rays,
                  std::size_t count, std::uint8_t* blocked, RayCounts& counts);

/** \brief Visits the blocks whose widened box a ray meets, roughly from near to far. */
void visitBlocks(const WideTree& tree, const BoundedRay& ray, const RayWidth& width,
                 const BlockVisitor& visitor, std::uint64_t& nodes);

}  // namespace kernels
}  // namespace pcl_slim::detail

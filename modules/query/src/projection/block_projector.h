// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/query/detail/block_means.h"
#include "pcl_slim/query/detail/projection_kernel.h"
#include "pcl_slim/query/projection.h"
#include "projection/placement.h"

namespace pcl_slim::detail {

/** \brief Projects the points of a store block by block onto the leaves of a surface, by equations
 * (6) to (8) with the guards of theory.md, "Projection". */
class BlockProjector {
 public:
  /** \brief What one thread needs beside the result. */
  struct Scratch {
    BlockSums sums;
    std::vector<BlockLeaf> near;       ///< the leaves of one block
    std::vector<LeafHeights> heights;  ///< under its points
  };

  /** \brief Everything named must outlive this object. \param[in] leaves those that places name. */
  BlockProjector(const PointStore& store, const SLIMSurface& surface,
                 const std::vector<std::uint32_t>& leaves, const ProjectionParams& params,
                 int threads);

  /** \brief Projects one block's points onto the leaves at some places. */
  void project(std::size_t block, const std::uint32_t* begin, const std::uint32_t* end,
               Scratch& scratch, Projection& result) const;

 private:
  /** A leaf in the store's units, but for its shift to a block. */
  struct PlacedLeaf {
    BlockLeaf leaf;
    std::array<double, 3> center;
  };

  PlacedLeaf placed(std::uint32_t i) const;
  BlockLeaf relativeTo(std::size_t block, const PlacedLeaf& placed) const;
  BlockPoints pointsOf(std::size_t block) const;
  void write(std::size_t i, std::size_t lane, const BlockSums& sums, const BlockMeans& means,
             Projection& result) const;
  void writeCurvature(std::size_t i, std::size_t lane, const BlockSums& sums,
                      const BlockMeans& means, Projection& result) const;

  const PointStore& store_;
  const SLIMSurface& surface_;
  Placement placement_;
  TrimTables trims_;
  std::vector<PlacedLeaf> placed_;
  BlendRules rules_;
  bool with_directions_;  ///< principal curvatures and directions
  float reach_;           ///< > 0: of the radius, in place of what residuals allow
  double noise_;          ///< sqrt(lambda) in the surface's local units
  bool by_normals_;       ///< whether points' own normals choose among leaves
  float min_dot_ = 0.0f;  ///< and the cosine from which on they do
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "octree/color_octree.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim::detail {

/** What the parameters of docs/color_octree_splat_sampler.md ask of each step of the sampling. */
struct SamplingPlan {
  SplatParams params;  ///< paper mode and the number of threads put in

  explicit SamplingPlan(const SplatParams& given);

  bool hasBudget() const { return params.max_splats > 0 || params.target_error > 0; }
  /** Whether cells are taken as the initial grid has them. */
  bool isUniform() const { return params.max_depth == 0 && !hasBudget(); }
  /** Whether discs follow their neighbours. */
  bool needsNeighbors() const { return params.radius == RadiusRule::kNeighbors; }
  /** Whether any rule takes noise off; else it is not measured. */
  bool needsNoise() const;

  /** Step 1: the grid of cubes. */
  RootGrid rootGrid() const;
  /** Step 2: when a cube is halved. */
  SplitRule splitRule(const SampleNoise& noise, bool normals_estimated) const;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim {

/** What a disc is made from beside the cells. */
struct SplatSources {
  const CloudView& cloud;
  const ColorView& colors;
  const LabTable& table;
  const PointStore* store;  ///< for RadiusRule::kNeighbors, else null
  SampleNoise noise;
};

/** One disc for each cell, in their order. Counts what it meets in statistics. */
void
buildSplats(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells,
            const SplatSources& sources, const SplatParams& params, SplatSet& splats,
            SplatStatistics& statistics);

/** Normals from the principal axes of each point's k nearest, facing viewpoint; three floats for
 * each point of the view, zero for those not asked for or not finite. store: the same points. */
std::vector<float>
estimateNormals(const PointStore& store, const CloudView& cloud, int neighbors,
                const double viewpoint[3], int threads);

}  // namespace pcl_slim

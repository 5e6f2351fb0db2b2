// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/features/crest_lines.h"

namespace pcl_slim::detail {

/** A place on the surface that a line of some type passes. */
struct CrestSeed {
  Vector3 position;  ///< the surface's local units
  Vector3 normal, t;
  double k;  ///< of the line's own curvature, 1/local length
};

/** Seeds between stored points and their neighbours, strongest first, ties by place.
 * \return one list a type; empty lists once cancelled. */
std::vector<std::vector<CrestSeed>>
findCrestSeeds(const PointStore& store, const Projection& projection, const SLIMSurface& surface,
               int threads, Progress* progress);

}  // namespace pcl_slim::detail

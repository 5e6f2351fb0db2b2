// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief The normal bound: the cosine up to which two normals of a store count as those of
 * different sheets.
 *
 * Exact normals part sheets that turn by more than 104 degrees: -0.25, so that faces at right angles are one
 * rounded surface. Three deviations of the normals' own errors may go below it, so that a ball that bends
 * keeps the points whose normals happen to be worst; never below -0.6. Sides that were found, not given, part
 * at right angles. Errors are the median angle between normals and the mean over their block, so edges and
 * curvature of most of the surface matter little. O(1000 blocks).
 */
PCL_SLIM_EXPORT float
normalBound(const PointStore& store, const NormalBoundConstants& constants = {});

}  // namespace pcl_slim::detail

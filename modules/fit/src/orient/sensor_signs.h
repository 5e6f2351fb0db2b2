// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Signs, one for each surfel, such that leaves face the sensors of their points: 1, or -1 for those
 * to be turned.
 *
 * Each point within a leaf's ball votes with the cosine between the leaf's normal at it and its beam,
 * weighted by nearness; points farther from the leaf than OrientConstants::sheet residuals are of
 * another sheet and vote only where there are no others. O(points gathered). \param[in] store the
 * points fitted, with sensors */
std::vector<signed char>
sensorSigns(const SLIMSurface& surface, const PointStore& store,
            const std::vector<std::uint32_t>& leaves, const OrientConstants& constants,
            int threads);

}  // namespace pcl_slim::detail

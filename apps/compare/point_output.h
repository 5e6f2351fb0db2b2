// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "compare/measurement.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief A's points, or a mesh's vertices and faces, with every field kept, and their deviations
 * in the fields deviation, level_of_detection, significant (1, 0, or -1 without a counterpart) and sigma_position; of a
 * surface, the places of its carrier with their normals. deviation and level_of_detection are NaN
 * where there is no counterpart.
 *
 * Coordinates are those of A's file, or with a motion where it takes them. O(points).
 * \param[in] deviations of comparison.atPoints() */
PointFile withDeviations(const ComparedInput& a, const Comparison& comparison,
                         const Deviations& deviations, bool moved);

}  // namespace pcl_slim

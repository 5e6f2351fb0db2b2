// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_table.h"
#include "pcl_slim/query/cloud_projection.h"

namespace pcl_slim {

/** \brief The points with what a projection knows of them in fields of these names; all other fields
 * are kept.
 *
 * x y z are the places on the surface, of points that no surfel supports their own; fields of whole
 * numbers become FLOAT64. normal_x normal_y normal_z, curvature (PCL's: the surface variation), k1 k2
 * mean_curvature gaussian_curvature, direction1_x ... direction2_z, and the standard errors
 * sigma_position and sigma_normal (of a projection with errors) are FLOAT32 unless the points have
 * such a field of real numbers; NaN where a value is unknown. Other names are left out.
 * \param[in] projection of all of these points, in their order. \param[in] threads 0: all cores.
 * O(points). */
PCL_SLIM_EXPORT PointTable withProjected(const PointTable& points,
                                         const CloudProjection& projection,
                                         const std::vector<std::string>& names, int threads);

}  // namespace pcl_slim

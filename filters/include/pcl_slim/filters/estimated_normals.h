// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Normals as pcl::NormalEstimation computes them, from the k nearest neighbours of each
 * point; the library pcl_slim::normals has it. No header of PCL is needed.
 *
 * They face the viewpoint or what findSensorEvidence() finds, else outward: see faceNormals().
 * \param[in] threads 0: all cores. \param[out] normals three floats for each point of the view, NaN
 * where there is no normal, as at points that are not finite. \return an error for a k below 3 or
 * beyond the number of finite points. May throw what PCL throws.
 */
PCL_SLIM_EXPORT Error estimateNormals(const CloudView& cloud, int k,
                                      const std::optional<std::array<double, 3>>& viewpoint,
                                      int threads, std::vector<float>& normals);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief The direction in which a sensor rounded its points, of any rotation of the cloud: the common normal of small
 * exactly plane terraces. None where few places are on such terraces. O(places). */
std::optional<Eigen::Vector3d>
findStepAxis(const PointStore& store, const StepConstants& constants, int threads);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Every stored point's foot on the plane of least squares of its k nearest points, itself included:
 * local positions. Where the store has sides, points of the other side are left out. O(n k). */
PCL_SLIM_EXPORT std::vector<std::array<double, 3>>
feetOnLocalPlanes(const PointStore& store, std::size_t k, int threads);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief What files of floats leave out of world coordinates, so that all files made of one cloud have the
 * same place in a viewer: 0 unless the cloud is 256 of its diagonals or more from the world's origin, else a
 * place near its middle, a multiple of four diagonals.
 * \param[in] origin of a store's or surface's local units \param[in] scale world units per local one */
PCL_SLIM_EXPORT std::array<double, 3>
fileShift(const std::array<double, 3>& origin, double scale);

/** \brief The same of a box around a cloud's points, in world coordinates. */
PCL_SLIM_EXPORT std::array<double, 3>
fileShift(const std::array<double, 3>& low, const std::array<double, 3>& high);

/** \brief The same of a cloud's finite points. O(points). */
PCL_SLIM_EXPORT std::array<double, 3>
fileShift(const CloudView& cloud);

}  // namespace pcl_slim

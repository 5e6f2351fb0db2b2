// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/error.h"
#include "store/bulk.h"

namespace pcl_slim::detail {

constexpr double kFarOrigin = 256.0;  ///< beyond this many L, world floats cannot be exact

/** \brief Sets origin, scale, diagonals and the grid of centres from the box of the points that count.
 * \param[in] least_span world length that the units span at least, 0: none. \return an error where
 * doubles cannot represent the units. */
Error
setUnits(const std::array<double, 3>& low, const std::array<double, 3>& high, const Bulk& bulk,
         double least_span, StoreFrame& frame);

}  // namespace pcl_slim::detail

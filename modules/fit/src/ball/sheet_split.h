// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace pcl_slim::detail {

/** \brief The interval of residuals that belongs to the centre's sheet. */
struct SheetRange {
  bool split = false;
  float low = 0, high = 0;
};

/** \brief Looks for two sheets in the residuals of one ball.
 *
 * Otsu's threshold on a 48-bin histogram; two sheets only if the valley between the modes falls
 * below 12 % of the lower one. \param[in] center_residual residual of the ball's centre.
 */
SheetRange
findSheet(const float* residuals, std::size_t count, double center_residual);

}  // namespace pcl_slim::detail

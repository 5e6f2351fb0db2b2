// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "common/program.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief "standard error 0 to 0.0198, dark to light". */
std::string errorRangeText(const std::array<double, 2>& range);

/** \brief Paints a surface with its standard error and prints the range of the colours.
 * \param[in] range that the colours span; equal: chosen by the errors \param[in] diverging colours
 * of -map diverging in place of dark to light \return the range. */
Result<std::array<double, 2>> paintErrors(const std::array<double, 2>& range, bool diverging,
                                          int threads, Console& console, SLIMSurface& surface);

}  // namespace pcl_slim

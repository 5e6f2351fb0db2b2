// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "benchmark/tables.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::comparison {

/** \brief Draws CPU time per point against RMS position error, both logarithmic, a panel a scene,
 * into a PNG file.
 *
 * \return an error where the chart cannot be drawn: no X server (VTK draws through one even off
 * the screen), a build without VTK's charts, nothing to draw, or a file that cannot be written.
 */
Error
drawChart(const std::vector<SceneRuns>& scenes, const std::string& path);

}  // namespace pcl_slim::comparison

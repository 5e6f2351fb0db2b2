// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface_components.h"

namespace pcl_slim {

/** \brief Adds -min_component, of programs that draw, mesh or sample a surface. */
void declareComponentOption(OptionTable& options, double& min_points);

/** \brief Removes small components; prints and reports what was left out, if anything, and which
 * option keeps it. \param[in] unloaded boxes of a surface's blocks that are not there */
void leaveOutComponents(double min_points, int threads, const std::vector<WorldBox>& unloaded,
                        Console& console, Report* report, SLIMSurface& surface);

/** \brief "left out: 3 small components of about 41 points; -min_component 0 keeps them". */
std::string leftOutText(std::uint64_t components, double points);

}  // namespace pcl_slim

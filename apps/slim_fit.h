// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/stream/ranks.h"

namespace pcl_slim {

/** \brief pcl_slim_fit: reads the arguments, fits a surface to a scan, in memory or by tiles, and
 * writes it. \param[in] ranks of a job, which fit by tiles together: the first one writes; null:
 * this process alone \return the exit status; messages are printed. */
int runFit(const char* program, int argc, const char* const* argv, Ranks* ranks);

}  // namespace pcl_slim

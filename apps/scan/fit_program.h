// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim {

/** \brief The program pcl_slim_fit: reads the arguments, fits a surface to a scan, in memory or by tiles,
 * and writes it. \return the exit status; messages are printed. */
int
runFitProgram(const char* program, const char* version, int argc, const char* const* argv);

}  // namespace pcl_slim

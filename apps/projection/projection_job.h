// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "pcl_slim/query/cloud_projection.h"
#include "scan/scan_program.h"

namespace pcl_slim {

/** \brief What the programs do alike that bring a scan onto its surface and write it again. */
struct ProjectionJob {
  ScanFiles files;
  std::string surface;  ///< a file to read instead of fitting, or none
  FitJob fit;
  ProjectionParams projection;
  bool mesh = false;  ///< smooth the scan's mesh in place of its points
};

/** \brief What a program of this kind is called, and the one switch of its own. */
struct ProjectionProgram {
  std::string name, version, summary;
  std::string switch_name, switch_help;  ///< the switch adds curvatures to the output
  bool meshes = false;                   ///< whether it has the option -mesh
  bool keeps_scan = false;  ///< a scan that is no surface is written unchanged, with a warning
};

/** \brief Makes the file to write from the file read and its projection. \param[in] chosen whether
 * the program's own switch is on; \param[in] threads 0: all cores. */
using MakeOutput = std::function<PointFile(const PointFile& file, const CloudProjection& projection,
                                           bool chosen, int threads)>;

/** \brief What became of the points, into the report. */
void
reportProjection(const CloudProjectionStatistics& statistics, Report& report);

/** \brief Reads the arguments, loads, fits or loads the surface, projects, writes and reports.
 * \return the exit status; messages are printed. */
int
runProjectionProgram(const ProjectionProgram& program, ProjectionJob& job, int argc,
                     const char* const* argv, const MakeOutput& make_output);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/fit_job.h"
#include "common/options.h"
#include "pcl_slim/filters/cloud_projection.h"

namespace pcl_slim {

/** \brief What the programs do alike that bring a scan onto its surface and write it again. */
struct ProjectionJob {
  std::string input, output, json, surface;
  FitJob fit;
  ProjectionParams projection;
  bool quiet = false;
};

/** \brief Declares IN and OUT. Options of the program's own follow, then declareProjectionOptions().
 * The job must outlive the table's parse(). */
void
declareScans(OptionTable& options, ProjectionJob& job);

/** \brief Declares -surface, the options of a fit, -json and -quiet. */
void
declareProjectionOptions(OptionTable& options, ProjectionJob& job);

/** \brief Makes the file to write from the file read and its projection. */
using MakeOutput =
    std::function<PointFile(const PointFile& file, const CloudProjection& projection)>;

/** \brief Reads the arguments, loads, fits or loads the surface, projects, writes and reports.
 * \return the exit status; messages are printed. */
int
runProjectionProgram(OptionTable& options, ProjectionJob& job, int argc, const char* const* argv,
                     const MakeOutput& make_output);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/surface/surface.h"
#include "scan/cloud_file.h"

namespace pcl_slim {

/** \brief Adds -colors: another cloud whose colours a surface gets. file must outlive the table's
 * parse(). */
void declarePaintOption(OptionTable& options, std::string& file);

/** \brief Loads the cloud of -colors; prints and reports it. \return an error where it has no
 * colours. */
Result<CloudFile> loadPaint(const std::string& file, Console& console, Report& report);

/** \brief Gives a surface the colours of a cloud; prints and reports which share of it got them. */
Error paintSurface(const CloudFile& paint, int threads, Console& console, Report& report,
                   SLIMSurface& surface);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "common/program.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/surface/surface.h"
#include "scan/cloud_file.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief What a file contains: a surface's .slim or .pvtp, or points. */
using ModelFile = std::variant<SLIMSurface, PointFile>;

/** \brief Reads a file, once. */
Result<ModelFile> readModelFile(const std::string& path, const PointFileOptions& options = {});

/** \brief A scan or, where the input's name or fields show one, a surface. */
struct ScanOrSurface {
  std::optional<CloudFile> scan;
  std::optional<SLIMSurface> surface;
};

/** \brief Loads either; prints and reports it. Of a pipe without an extension the content shows what
 * it is. */
Error loadScanOrSurface(const std::string& path, const FitJob& job, Console& console,
                        Report& report, ScanOrSurface& input);

/** \brief Loads a surface; prints and reports it. */
Error loadGiven(const std::string& path, Console& console, Report& report, SLIMSurface& surface);

}  // namespace pcl_slim

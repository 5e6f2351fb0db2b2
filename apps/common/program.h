// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/progress_bar.h"
#include "common/report.h"
#include "common/run_program.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Whether two names stand for one file; an empty name stands for none. */
bool
samePlace(const std::string& a, const std::string& b);

/** \brief Whether output and report (none if empty) can be written; says why not. */
Error
checkOutputs(const std::string& output, const std::string& report);

/** \brief The last stage of a program: saves its output, then its report, and says so. Without the
 * report no output is left either.
 * \param[in] save writes the output; \param[in] detail what it holds: "5000 surfels". */
Error
saveOutput(const std::string& output, const std::string& report_file,
           const std::function<Error()>& save, const std::string& detail, Console& console,
           Report& report);

}  // namespace pcl_slim

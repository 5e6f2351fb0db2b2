// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/progress_bar.h"
#include "common/report.h"
#include "common/run_program.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

/** \brief Whether two names stand for one file; an empty name stands for none. */
bool
samePlace(const std::string& a, const std::string& b);

/** \brief Whether files that are written differ from those that are read, and from each other; empty
 * names stand for none. */
Error
checkPlaces(const std::vector<std::string>& read, const std::vector<std::string>& written);

/** \brief Whether output and report (none where empty) can be written; says why not. */
Error
checkOutputs(const std::string& output, const std::string& report);

/** \brief The last stage of a program: saves its output and its report, and says so. Both appear, or
 * neither; an older output stays when something fails. Signals end nothing from then on.
 * \param[in] save writes the output; \param[in] detail what it holds: "5000 surfels". */
Error
saveOutput(const std::string& output, const std::string& report_file,
           const std::function<Error()>& save, const std::string& detail, Console& console,
           Report& report);

/** \brief Puts a program's files in their places, unless a signal has come: then none of them. */
Error
commitOutputs(FileTransaction& files);

}  // namespace pcl_slim

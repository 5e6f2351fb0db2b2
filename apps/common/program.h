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

/** \brief Whether two names are of one file; an empty name is of none. */
bool
samePlace(const std::string& a, const std::string& b);

/** \brief Whether the files written differ from the files read and from each other; empty
 * names are of no file. */
Error
checkPlaces(const std::vector<std::string>& read, const std::vector<std::string>& written);

/** \brief Whether output and report (none where empty) can be written; returns the reason if not. */
Error
checkOutputs(const std::string& output, const std::string& report);

/** \brief The last stage of a program: saves its output and its report and prints it. Both appear, or
 * neither; an older output stays when something fails. Signals end nothing from then on.
 * \param[in] save writes the output; \param[in] detail its contents: "5000 surfels". */
Error
saveOutput(const std::string& output, const std::string& report_file,
           const std::function<Error()>& save, const std::string& detail, Console& console,
           Report& report);

/** \brief Puts a program's files in their places, unless a signal has come: then none of them. */
Error
commitOutputs(FileTransaction& files);

}  // namespace pcl_slim

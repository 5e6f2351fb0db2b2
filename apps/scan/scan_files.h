// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"

namespace pcl_slim {

/** \brief The files of a program that makes one file of a scan, and whether it is to be quiet. */
struct ScanFiles {
  std::string input, output, json;  ///< json: the report's file, or none
  OutputNames names;                ///< in place of output
  bool quiet = false;
};

/** \brief Declares -out and -format, where several inputs are possible, -json, -max_memory and
 * -quiet; files must outlive the table's parse(). */
void declareReport(OptionTable& options, ScanFiles& files, bool several = true);

/** \brief No error unless input, output and report share a file, or one that is written with others
 * that are read. */
Error checkFilesDiffer(const ScanFiles& files, const std::vector<std::string>& read);

/** \brief No error for a name that ends in .pcd, .ply or .vtp, or in .las where that can be
 * written. */
Error checkPointExtension(const std::string& path, bool las = false);

/** \brief Prints a warning where a file's format does not keep an organised cloud's rows or a
 * sensor of the scan. */
void noteWhatIsNotKept(const std::string& path, bool rows, bool sensor, Console& console);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/options.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief The files of a program that makes one file of a scan, and whether it is to be quiet. */
struct ScanFiles {
  std::string input, output, json;  ///< json: the report's file, or none
  std::uint64_t max_memory = 0;     ///< megabytes; 0: no limit
  bool quiet = false;
};

/** \brief Declares -json, -max_memory and -quiet; files must outlive the table's parse(). */
void declareReport(OptionTable& options, ScanFiles& files);

/** \brief No error unless input, output and report share a file, or one that is written with others
 * that are read. */
Error checkFilesDiffer(const ScanFiles& files, const std::vector<std::string>& read);

/** \brief No error for a name that ends in .pcd, .ply or .vtp, or in .las where that can be
 * written. */
Error checkPointExtension(const std::string& path, bool las = false);

/** \brief Prints a warning where a file's format does not keep an organised cloud's rows or a
 * sensor of the scan. */
void noteWhatIsNotKept(const std::string& path, bool rows, bool sensor, Console& console);

/** \brief What a program makes of a scan. */
struct ScanResult {
  std::function<Error()> save;  ///< writes it
  std::string detail;           ///< what it is: "5000 surfels"
  std::function<void()> done;   ///< called once it is written; may be null
  bool report_only = false;     ///< there is nothing to write but the report
};

/** \brief The steps of a program that makes one file of a scan, in the order they are run. */
struct ScanSteps {
  /** \brief Checks options before any file is read; an error exits with kExitUsage. */
  std::function<Error()> check;
  /** \brief Reads what else is needed, if anything; an error exits with kExitUsage. The cloud is
   * null where open() took the input. */
  std::function<Error(const CloudFile* cloud, Console&, Report&)> load;
  /** \brief The work; an error exits with kExitFailed. The cloud is null where open() took the
   * input. */
  std::function<Error(const CloudFile* cloud, Console&, Report&, ScanResult&)> work;
  /** \brief Opens an input that is not to be loaded as a scan; null: every input is loaded. An
   * error exits with kExitUsage. \return whether it took this input. */
  std::function<Result<bool>(Console&)> open;
  /** \brief The work on what open() took, if work() is not for it; an error exits with kExitFailed,
   * one of the input with kExitUsage. */
  std::function<Error(Console&, Report&, ScanResult&)> stream;
};

/** \brief Reads the arguments, loads the scan, works, writes result and report, and prints it.
 * \param[in] scan how the scan is loaded; \param[in] threads as given in the report, 0: all cores.
 * Both are read after the arguments. \return the exit status; after Ctrl-C nothing is written. */
int runScanProgram(OptionTable& options, int argc, const char* const* argv, const ScanFiles& files,
                   const FitJob& scan, const int& threads, const ScanSteps& steps);

}  // namespace pcl_slim

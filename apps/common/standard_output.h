// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/options.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief Standard output in place of a file that a program writes.
 *
 * The program writes a temporary file of the right extension, so that every format can be written,
 * also those whose header is completed last; the bytes follow when the work is done. Until then what
 * is printed goes to standard error, whoever prints it: the stream has the file's bytes alone.
 */
class StandardOutput {
 public:
  StandardOutput() = default;
  /** \brief Removes the temporary file. */
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /** \brief Puts the name of a temporary file in the place of a "-" that a file to write is named
   * by, if there is one. \return an error where the format is unknown or is several files, or where
   * the stream is a terminal that cannot show it. */
  Error take(OptionTable& options);

  /** \brief Writes the file's bytes to standard output, and removes the file. */
  Error send();

 private:
  Error send(int file);

  std::string path_;
  int stream_ = -1;
};

/** \brief Whether a file is the one that standard output gets. */
bool isStandardOutput(const std::string& path);

/** \brief What users read of a file that is written: its name, or "standard output". */
std::string shownName(const std::string& path);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief What a user says about a file of points that its reader cannot know. */
struct InputOptions {
  PointFileOptions file;
  std::string units = "detect";
};

/** \brief Adds -columns, -units and -min_opacity; they must outlive the table's parse(). */
void declareInputOptions(OptionTable& options, InputOptions& input);

/** \brief What is wrong with the options themselves. */
Error checkInputOptions(const InputOptions& input);

/** \brief Loads points, whose x y z must be lengths unless the user says that they are. \param[in,out] read
 * the same file, if it is read already, which is then taken. */
Result<PointFile> loadPoints(const std::string& path, const InputOptions& input,
                             PointFile* read = nullptr);

/** \brief Prints and reports what the reader made of a file's content. */
void noteInput(const PointFile& file, const InputOptions& input, Console& console, Report& report);

}  // namespace pcl_slim

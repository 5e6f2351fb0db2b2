// SPDX-License-Identifier: BSD-3-Clause
#include "scan/input_options.h"

#include <utility>

#include "pcl_slim/filters/io/point_units.h"

namespace pcl_slim {

void declareInputOptions(OptionTable& options, InputOptions& input) {
  options.text(
      "columns", &input.file.columns, "NAME,...",
      "what the columns of a text file are, as x,y,z,i,r,g,b,-; - leaves one out; not given: "
      "the file's names, or guessed");
  options.choice("units", &input.units, {"detect", "length"},
                 "length: x and y are lengths, even if they look like degrees");
  options.number("min_opacity", &input.file.min_opacity, 0, 1,
                 "of 3D Gaussian splats (.ply): those of lower opacity are left out");
}

Error checkInputOptions(const InputOptions& input) {
  return checkColumns(input.file.columns);
}

Result<PointFile> loadPoints(const std::string& path, const InputOptions& input, PointFile* read) {
  Result<PointFile> file = read != nullptr ? std::move(*read) : loadPointFile(path, input.file);
  if (!file || input.units == "length") return file;
  if (Error error = checkLengths(*file, path)) return error;
  return file;
}

void noteInput(const PointFile& file, const InputOptions& input, Console& console, Report& report) {
  if (!file.columns.empty()) {
    console.note("  columns: " + file.columns);
    report.set("columns", file.columns);
  }
  for (const std::string& note : file.notes) console.note("  " + note);
  for (const std::string& warning : file.warnings) console.warn(warning);
  if (!file.warnings.empty()) report.set("warnings", file.warnings);
  const bool splats = findField(file.cloud, "f_dc_0") >= 0;
  if (!splats && input.file.min_opacity != PointFileOptions().min_opacity)
    console.note("  -min_opacity has no effect: the file has no Gaussian splats");
}

}  // namespace pcl_slim

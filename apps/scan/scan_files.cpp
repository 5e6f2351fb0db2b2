// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_files.h"

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

void declareReport(OptionTable& options, ScanFiles& files, bool several) {
  if (several) options.outputNames(&files.names);
  options.text("json", &files.json, "FILE", "write a report", FileUse::kWritten);
  declareMemoryLimit(options);
  options.toggle("quiet", &files.quiet, "say nothing but errors");
}

Error checkFilesDiffer(const ScanFiles& files, const std::vector<std::string>& read) {
  if (Error error = checkPlaces(read, {files.output, files.json})) return error;
  if (!samePlace(files.input, files.output) && !samePlace(files.json, files.input) &&
      !samePlace(files.json, files.output)) {
    return {};
  }
  return {ErrorCode::kBadArgument, "input, output and report share a file; name different ones"};
}

Error checkPointExtension(const std::string& path, bool las) {
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return checkPointFileExtension(path);
  if (extension == ".pcd" || extension == ".ply" || (las && extension == ".las")) return {};
  return {ErrorCode::kBadArgument, "cannot tell the format of '" + path + "'; name a .pcd, .ply" +
                                       (las ? ", .las" : "") + " or .vtp file"};
}

void noteWhatIsNotKept(const std::string& path, bool rows, bool sensor, Console& console) {
  const std::string extension = lowerExtension(path);
  if (extension == ".pcd" || !(rows || sensor)) return;
  const std::string what = !sensor ? "rows" : !rows ? "sensor" : "rows and sensor";
  console.note("  " + extension + " does not keep the scan's " + what + "; .pcd does");
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "common/program.h"

#include <filesystem>

#include "common/interrupt.h"

namespace pcl_slim {

bool
samePlace(const std::string& a, const std::string& b)
{
  if (a.empty() || b.empty()) return false;
  std::error_code code;
  if (a == b || std::filesystem::equivalent(a, b, code)) return true;
  // Of files that are not there yet, or links to such.
  const std::string first = placeOf(a), second = placeOf(b);
  return !first.empty() && first == second;
}

Error
checkPlaces(const std::vector<std::string>& read, const std::vector<std::string>& written)
{
  for (std::size_t i = 0; i < written.size(); ++i) {
    for (const std::string& name : read) {
      if (samePlace(name, written[i])) {
        return {ErrorCode::kBadArgument, "'" + name + "' would be overwritten; name another file"};
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (samePlace(written[j], written[i])) {
        return {ErrorCode::kBadArgument,
                "two outputs share a file, '" + written[i] + "'; name different ones"};
      }
    }
  }
  return {};
}

Error
checkOutputs(const std::string& output, const std::string& report)
{
  Error error;
  if (!output.empty()) error = checkWritable(output);
  if (!error && !report.empty()) error = checkWritable(report);
  return error;
}

Error
saveOutput(const std::string& output, const std::string& report_file,
           const std::function<Error()>& save, const std::string& detail, Console& console,
           Report& report)
{
  FileTransaction files;
  console.begin("Saving " + output);
  Error error = save();
  const double seconds = console.seconds();
  report.time("save", seconds);
  report.json()["output"] = output;
  if (!error) error = report.write(report_file);
  if (!error) error = commitOutputs(files);
  if (error) return console.failed(error);
  console.done(seconds, detail);
  return {};
}

Error
commitOutputs(FileTransaction& files)
{
  if (!outlastSignals()) return {ErrorCode::kCancelled, "stopped; nothing is written"};
  return files.commit();
}

}  // namespace pcl_slim

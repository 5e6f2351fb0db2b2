// SPDX-License-Identifier: BSD-3-Clause
#include "common/report.h"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#endif

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

Report::Report(const std::string& program, const std::string& version, const std::string& input,
               int threads)
{
  json_["program"] = program;
  json_["version"] = version;
  json_["input"] = input;
  json_["points"] = 0;
  json_["threads"] = threads;
  json_["seconds"]["total"] = 0.0;
  json_["peak_rss_mb"] = 0.0;
}

void
Report::time(const std::string& stage, double seconds)
{
  json_["seconds"][stage] = seconds;
}

Error
Report::write(const std::string& path)
{
  if (path.empty()) return {};
  json_["seconds"]["total"] = total_.seconds();
  json_["peak_rss_mb"] = peakMemoryMb();
  // File names need not be UTF-8, JSON must be.
  const std::string text =
      json_.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return writeFile(path, text.data(), text.size());
}

double
peakMemoryMb()
{
#if defined(__unix__) || defined(__APPLE__)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
#ifdef __APPLE__
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);  // bytes there
#else
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
#endif
#else
  return 0.0;
#endif
}

}  // namespace pcl_slim

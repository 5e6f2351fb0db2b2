// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/bench.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "hwy/targets.h"
#include "support/lab/scenes.h"

namespace pcl_slim::measure {

namespace {

/** A value of /proc/self/status in bytes; negative if it cannot be read. */
double processStatus(const char* key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, std::strlen(key), key) == 0) {
      return 1024.0 * std::strtod(line.c_str() + std::strlen(key), nullptr);
    }
  }
  return -1;
}

}  // namespace

double cpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

MemoryGauge::MemoryGauge() {
  malloc_trim(0);
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5";
  reset.close();
  start_ = processStatus("VmRSS:");
  // Where the mark cannot be restarted it still shows the process's past.
  works_ = reset.good() && start_ >= 0;
}

double MemoryGauge::peakBytes() const {
  const double peak = works_ ? processStatus("VmHWM:") : -1;
  return peak < 0 ? -1 : std::max(0.0, peak - start_);
}

void keepFreedMemory() {
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_MMAP_THRESHOLD, 1 << 25);
}

namespace {

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::stringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

bool parseValue(const ListOption& option, const std::string& text, double& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) return false;
  if (option.whole && value != std::floor(value)) return false;
  return value >= option.low && value <= option.high;
}

}  // namespace

Error parseLists(const std::vector<ListOption>& options) {
  for (const ListOption& option : options) {
    option.values->clear();
    for (const std::string& part : split(*option.text)) {
      double value = 0;
      if (!parseValue(option, part, value)) {
        std::ostringstream message;
        message << "option -" << option.name << " got '" << part << "'; give "
                << (option.whole ? "whole " : "") << "numbers from " << option.low << " to "
                << option.high << ", separated by commas";
        return {ErrorCode::kBadArgument, message.str()};
      }
      option.values->push_back(value);
    }
    if (option.values->empty()) {
      return {ErrorCode::kBadArgument,
              std::string("option -") + option.name + " is empty; give at least one number"};
    }
  }
  return {};
}

Error parseShapes(const std::string& text, std::vector<std::string>& names) {
  names = split(text);
  Shape shape;
  for (const std::string& name : names) {
    if (parseShape(name, shape)) continue;
    return {ErrorCode::kBadArgument,
            "unknown shape '" + name + "'; give sphere, torus, bumpy or relief"};
  }
  if (names.empty()) {
    return {ErrorCode::kBadArgument, "no shape is named; give sphere, torus, bumpy or relief"};
  }
  return {};
}

Result<std::vector<std::string>> scansIn(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".pcd" || kind == ".ply") files.push_back(entry.path().string());
  }
  if (failure) return Error{ErrorCode::kIo, folder + ": " + failure.message()};
  std::sort(files.begin(), files.end());
  return files;
}

Error chooseVectors(const std::string& name) {
  if (name == "best") return {};
  std::string known;
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    known += std::string(" ") + hwy::TargetName(target);
    if (name != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(left);  // it and older ones, for kernels that leave it out
    hwy::GetChosenTarget().DeInit();
    return {};
  }
  return {ErrorCode::kBadArgument, "this processor has no instructions '" + name +
                                       "'; give -vectors best or one of" + known};
}

}  // namespace pcl_slim::measure

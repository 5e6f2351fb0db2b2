// SPDX-License-Identifier: BSD-3-Clause
#include "measure/clocks.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace pcl_slim::measure {

namespace {

/** A value of /proc/self/status in bytes; negative if it cannot be read. */
double
processStatus(const char* key)
{
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, std::strlen(key), key) == 0) {
      return 1024.0 * std::strtod(line.c_str() + std::strlen(key), nullptr);
    }
  }
  return -1;
}

}  // namespace

double
cpuSeconds()
{
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double
wallSeconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double
median(std::vector<double> values)
{
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

MemoryGauge::MemoryGauge()
{
  malloc_trim(0);
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5";
  reset.close();
  start_ = processStatus("VmRSS:");
  // Where the mark cannot be restarted it still shows the process's past.
  works_ = reset.good() && start_ >= 0;
}

double
MemoryGauge::peakBytes() const
{
  const double peak = works_ ? processStatus("VmHWM:") : -1;
  return peak < 0 ? -1 : std::max(0.0, peak - start_);
}

void
keepFreedMemory()
{
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_MMAP_THRESHOLD, 1 << 25);
}

}  // namespace pcl_slim::measure

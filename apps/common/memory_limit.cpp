// SPDX-License-Identifier: BSD-3-Clause
#include "common/memory_limit.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#if defined(__linux__)
#include <sys/resource.h>
#endif

namespace pcl_slim {

namespace {

constexpr double kMegabyte = 1024.0 * 1024.0;
constexpr std::uint64_t kMostMegabytes = 1000000000000000000u;
constexpr double kStack = 8 * kMegabyte;  ///< address space that a thread reserves and hardly uses

std::uint64_t limit = 0;  ///< megabytes; 0: none

/** A line of the system's report on this process or the machine, in bytes; 0 where there is none. */
double
statusOf(const std::string& key, const char* file = "/proc/self/status")
{
  std::ifstream status(file);
  for (std::string line; std::getline(status, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    double kilobytes = 0;
    std::istringstream(line.substr(key.size())) >> kilobytes;
    return 1024.0 * kilobytes;
  }
  return 0.0;
}

std::string
megabytesText(double bytes)
{
  return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes / kMegabyte))) + " MB";
}

}  // namespace

void
declareMemoryLimit(OptionTable& options, std::uint64_t* megabytes)
{
  options.integer("max_memory", megabytes, 0, kMostMegabytes,
                  "most memory to take, in MB: work that needs more is refused; 0: all there is");
}

Error
limitMemory(std::uint64_t megabytes)
{
  limit = megabytes;
  if (megabytes == 0) return {};
  const double wanted = kMegabyte * static_cast<double>(megabytes), now = statusOf("VmRSS:");
  if (wanted <= now) {
    return {ErrorCode::kBadArgument, "-max_memory " + std::to_string(megabytes) +
                                         " is less than the program itself takes: allow " +
                                         megabytesText(2 * now) + " or more"};
  }
#if defined(__linux__)
  // Private memory is limited; what is mapped from files, as the program itself, is not.
  const double stacks = kStack * (1 + std::thread::hardware_concurrency());
  rlimit bound{};
  if (getrlimit(RLIMIT_DATA, &bound) == 0) {
    const double most = statusOf("VmData:") + wanted - now + stacks;
    if (bound.rlim_max == RLIM_INFINITY || most < static_cast<double>(bound.rlim_max)) {
      bound.rlim_cur = static_cast<rlim_t>(most);
      setrlimit(RLIMIT_DATA, &bound);
    }
  }
#endif
  return {};
}

Error
checkMemory(double bytes, const std::string& what, const std::string& relief)
{
  const double needed = bytes + statusOf("VmRSS:");
  if (limit == 0 || needed <= kMegabyte * static_cast<double>(limit)) return {};
  return badInput(what + " takes " + megabytesText(needed) + " or more, above -max_memory " +
                  std::to_string(limit) + ": raise it, or " + relief);
}

double
memoryLeft()
{
  constexpr double kShare = 0.8;
  if (limit == 0) {
    const double free = statusOf("MemAvailable:", "/proc/meminfo");
    return free > 0 ? kShare * free : HUGE_VAL;
  }
  return std::fmax(0.0, kMegabyte * static_cast<double>(limit) - statusOf("VmRSS:"));
}

std::string
memoryLimitText()
{
  return limit == 0 ? "" : " within -max_memory " + std::to_string(limit);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "common/run_program.h"

#include <cstdio>
#include <filesystem>
#include <new>

#include "common/interrupt.h"
#include "common/memory_limit.h"

namespace pcl_slim {

int
fail(const std::string& program, int status, const std::string& message)
{
  std::fprintf(stderr, "%s: %s\n", program.c_str(), message.c_str());
  return status;
}

int
failWork(const std::string& program, const Error& error)
{
  const bool stopped = error.code == ErrorCode::kCancelled;
  return fail(program, stopped ? kExitInterrupted : kExitFailed, error.message);
}

int
guarded(const std::string& program, const std::string& relief, const std::function<int()>& work)
{
  endOnSignals();
  try {
    const int status = work();
    return status == kExitInterrupted && receivedSignal() != 0 ? 128 + receivedSignal() : status;
  } catch (const std::bad_alloc&) {
    return fail(program, kExitFailed,
                "not enough memory" + memoryLimitText() + "; " + relief + " or fewer -threads");
  } catch (const std::exception& failure) {
    return fail(program, kExitFailed, failure.what());
  }
}

int
runProgram(OptionTable& options, int argc, const char* const* argv, const std::string& relief,
           const std::function<Error()>& check, const std::function<Error()>& work)
{
  return guarded(options.program(), relief, [&]() -> int {
    if (const auto status = options.parse(argc, argv)) return *status;
    if (const Error error = check()) return fail(options.program(), kExitUsage, error.message);
    if (const Error error = work()) return failWork(options.program(), error);
    return kExitDone;
  });
}

std::string
commandLine(int argc, const char* const* argv)
{
  std::string text = std::filesystem::path(argv[0]).filename().string();
  for (int i = 1; i < argc; ++i) text += std::string(" ") + argv[i];
  return text;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "common/program.h"

#include <cstdio>
#include <filesystem>
#include <new>

#include "common/interrupt.h"
#include "common/options.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

int
fail(const std::string& program, int status, const std::string& message)
{
  std::fprintf(stderr, "%s: %s\n", program.c_str(), message.c_str());
  return status;
}

int
guarded(const std::string& program, const std::string& relief, const std::function<int()>& work)
{
  endOnSignals();
  try {
    const int status = work();
    return status == kExitInterrupted && receivedSignal() != 0 ? 128 + receivedSignal() : status;
  } catch (const std::bad_alloc&) {
    return fail(program, kExitFailed, "not enough memory; " + relief + " or fewer -threads");
  } catch (const std::exception& failure) {
    return fail(program, kExitFailed, failure.what());
  }
}

bool
samePlace(const std::string& a, const std::string& b)
{
  std::error_code code;
  return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, code));
}

Error
checkOutputs(const std::string& output, const std::string& report)
{
  Error error = checkWritable(output);
  if (!error && !report.empty()) error = checkWritable(report);
  return error;
}

Error
saveOutput(const std::string& output, const std::string& report_file,
           const std::function<Error()>& save, const std::string& detail, Console& console,
           Report& report)
{
  const Stopwatch watch;
  console.begin("Saving " + output);
  if (Error error = save()) {
    console.failed();
    return error;
  }
  report.time("save", watch.seconds());
  console.done(watch.seconds(), detail);
  report.json()["output"] = output;
  Error error = report.write(report_file);
  std::error_code code;
  if (error) std::filesystem::remove(output, code);
  return error;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/controlled_run.h"

#include <exception>
#include <new>

namespace pcl_slim {

void
ControlledRun::clearResults()
{
  error_ = {};
}

bool
ControlledRun::fail(ErrorCode code, const std::string& message)
{
  error_ = {code, message};
  return false;
}

bool
ControlledRun::guardedCall(const char* work, const char* remedy, Error (*call)(const void*),
                           const void* body)
{
  try {
    error_ = call(body);
    // Checked after the last progress report: a caller who cancels wants no result.
    if (!error_ && control_.progress.cancelled()) {
      fail(ErrorCode::kCancelled, std::string(work) + " was cancelled");
    }
  } catch (const std::bad_alloc&) {
    fail(ErrorCode::kBadInput, std::string("not enough memory for this cloud; ") + remedy);
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string(work) + " stopped: " + failure.what());
  }
  return !error_;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "thread_team.h"

#include <algorithm>
#include <system_error>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pcl_slim::detail {

namespace {

constexpr int kSpins = 2000;  ///< some tens of microseconds

/** Waits awake for a moment. \return whether it came true meanwhile. */
template <typename Condition>
bool
comesSoon(const Condition& condition)
{
  for (int spin = 0; spin < kSpins; ++spin) {
    if (condition()) return true;
#if defined(__x86_64__)
    _mm_pause();
#endif
  }
  return condition();
}

}  // namespace

ThreadTeam::~ThreadTeam()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
    ++round_;
  }
  called_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void
ThreadTeam::run(int threads, Work work, void* context)
{
  spawn(threads - 1);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    work_ = work;
    context_ = context;
    wanted_ = std::min(threads - 1, static_cast<int>(helpers_.size()));
    busy_ = wanted_;
    ++round_;
  }
  called_.notify_all();
  work(context, 0);
  const auto finished = [this] { return busy_ == 0; };
  if (comesSoon(finished)) return;
  std::unique_lock<std::mutex> lock(mutex_);
  finished_.wait(lock, finished);
}

void
ThreadTeam::spawn(int helpers)
{
  try {
    for (int thread = static_cast<int>(helpers_.size()) + 1; thread <= helpers; ++thread) {
      helpers_.emplace_back([this, thread, round = round_.load()] { serve(thread, round); });
    }
  } catch (const std::system_error&) {
    // The system has no more threads: those there are share the work.
  }
}

void
ThreadTeam::serve(int thread, std::uint64_t round)
{
  while (waitForRound(thread, round)) {
    work_(context_, thread);
    if (--busy_ > 0) continue;
    // Under the lock the caller is asleep, or has yet to look and will see that none is busy.
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_.notify_one();
  }
}

/** Waits for the next round that wants this thread. \return false: the team stops. */
bool
ThreadTeam::waitForRound(int thread, std::uint64_t& round)
{
  const auto next = [&] { return round_ != round; };
  for (;;) {
    comesSoon(next);
    std::unique_lock<std::mutex> lock(mutex_);
    called_.wait(lock, next);
    round = round_;
    if (stopped_) return false;
    if (thread <= wanted_) return true;
  }
}

}  // namespace pcl_slim::detail

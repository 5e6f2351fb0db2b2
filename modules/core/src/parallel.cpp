// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <new>
#include <optional>
#include <thread>

#ifdef __SANITIZE_THREAD__
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace pcl_slim {

namespace {

thread_local bool in_loop = false;  ///< a body of a loop runs on this thread

/** Report to the thread sanitizer how oneTBB, built without it, orders a loop's threads: the caller
 * before all shares, and those before what follows the loop. */
void handOver([[maybe_unused]] void* loop) {
#ifdef __SANITIZE_THREAD__
  __tsan_release(loop);
#endif
}

void takeOver([[maybe_unused]] void* loop) {
#ifdef __SANITIZE_THREAD__
  __tsan_acquire(loop);
#endif
}

/** An arena of at least this many threads in oneTBB's pool, which all callers share. Each calling
 * thread keeps its own: a fit is some hundred short loops, and helpers that still look out for work
 * there start with the next immediately. It only grows, as making one costs more than a short loop
 * does. Against a thread team of our own, one for each calling thread, this took .96 to 1.02 of the
 * wall time. */
tbb::task_arena& arenaOf(int threads) {
  thread_local std::optional<tbb::task_arena> arena;
  if (!arena || arena->max_concurrency() < threads) arena.emplace(threads);
  return *arena;
}

/** Whether oneTBB is initialised. It initialises once: if memory was short then, the next caller
 * waits for ever; so loops run on their calling threads from then on, with the same results. */
bool poolStands() {
  static const bool stands = [] {
    try {
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }();
  return stands;
}

/** Threads that the pool grants; it would print a warning if more were requested. */
int granted(int threads) {
  if (threads <= 1 || !poolStands()) return 1;
  const std::size_t most =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(std::min(static_cast<std::size_t>(threads), most));
}

}  // namespace

Error checkThreads(int requested) {
  if (requested >= 0 && requested <= kMostThreads) return {};
  return {ErrorCode::kBadArgument, "the number of threads must be 0 (all cores) to 4096"};
}

int resolveThreads(int requested) {
  if (requested > 0) return requested;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace internal {

void runOnTeam(int threads, void (*work)(void*, int), void* context) {
  const int shares = in_loop ? 1 : granted(threads);
  if (shares <= 1) return work(context, 0);
  char begin = 0, end = 0;  // their addresses represent the loop's two ends
  const auto run = [work, context, from = &begin, to = &end](int share) {
    takeOver(from);
    in_loop = true;
    work(context, share);
    in_loop = false;
    handOver(to);
  };
  handOver(&begin);
  arenaOf(shares).execute([&] { tbb::parallel_for(0, shares, run, tbb::simple_partitioner()); });
  takeOver(&end);
}

}  // namespace internal

}  // namespace pcl_slim

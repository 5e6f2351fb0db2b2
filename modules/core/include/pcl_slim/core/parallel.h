// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Largest number of threads accepted; more are a mistake, and each costs memory. */
constexpr int kMostThreads = 4096;

/** \brief An error for a number of threads that is negative or above kMostThreads. */
PCL_SLIM_EXPORT Error checkThreads(int requested);

/** \brief Number of threads to use for a request: 0 (or less) means every available core. */
PCL_SLIM_EXPORT int resolveThreads(int requested);

namespace internal {

/** Runs work(context, thread) once on each thread, the caller being thread 0; called from inside
 * such work, on the caller alone. */
PCL_SLIM_EXPORT void runOnTeam(int threads, void (*work)(void*, int), void* context);

}  // namespace internal

/** \brief Runs body(i, thread) for i in [0, count), in chunks handed out dynamically.
 *
 * The order in which indices run is unspecified, so body must write by index only; sums belong into
 * fixed-size partial results that are added in index order afterwards. All callers share one pool,
 * oneTBB's: fewer threads than requested may run, so no body may wait for another to begin. Loops
 * inside a body run on its thread alone. An exception of a body ends the loop and is rethrown.
 */
template <typename Body>
void parallelFor(std::size_t count, int threads, std::size_t chunk, const Body& body) {
  if (threads <= 1 || count <= chunk) {
    for (std::size_t i = 0; i < count; ++i) body(i, 0);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  auto takeChunks = [&](int thread) {
    try {
      for (std::size_t begin = next.fetch_add(chunk); begin < count;
           begin = next.fetch_add(chunk)) {
        const std::size_t end = std::min(begin + chunk, count);
        for (std::size_t i = begin; i < end; ++i) body(i, thread);
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;
    }
  };
  using Work = decltype(takeChunks);
  internal::runOnTeam(
      threads, [](void* work, int thread) { (*static_cast<Work*>(work))(thread); }, &takeChunks);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace pcl_slim

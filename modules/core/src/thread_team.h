// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace pcl_slim::detail {

/** \brief The threads that help one calling thread.
 *
 * A fit is some hundred short loops. Between them helpers stay awake for a moment, as the next
 * loop mostly comes at once, and then sleep: threads that kept spinning, as those of OpenMP do by
 * default, would hold the cores against the very threads they wait for wherever other programs run
 * too (benchmarks/reports/benchmarks.md, "Time and memory of the fit").
 */
class ThreadTeam {
 public:
  /** \brief work(context, thread), which must not throw. */
  using Work = void (*)(void* context, int thread);

  ThreadTeam() = default;
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  ~ThreadTeam();

  /** \brief Runs work once on each of some threads, the caller as thread 0, and waits for all.
   * Where the system grants fewer threads, fewer run. */
  void run(int threads, Work work, void* context);

 private:
  void spawn(int helpers);
  void serve(int thread, std::uint64_t round);
  bool waitForRound(int thread, std::uint64_t& round);

  std::vector<std::thread> helpers_;
  std::mutex mutex_;
  std::condition_variable called_, finished_;
  std::atomic<std::uint64_t> round_{0};  ///< grows with each call of run
  std::atomic<int> busy_{0};             ///< helpers that have not finished this round
  int wanted_ = 0;                       ///< helpers that take part in it
  bool stopped_ = false;
  Work work_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>

namespace pcl_slim {

/** \brief Reports how far a long computation is and lets the caller stop it.
 *
 * Algorithms call report() from the thread that started them, never from inside a parallel
 * region, and poll cancelled() between chunks of work. cancel() may be called from any thread
 * or from a signal handler.
 */
class Progress {
 public:
  /** \brief Called with the fraction done in [0, 1] and the name of the running stage. */
  using Callback = std::function<void(float fraction, const char* stage)>;

  Progress() = default;
  explicit Progress(Callback callback) : callback_(std::move(callback)) {}

  void report(float fraction, const char* stage)
  {
    if (callback_) callback_(fraction, stage);
  }

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  /** \brief Takes cancel() back. */
  void reset() { cancelled_.store(false, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  Callback callback_;
  std::atomic<bool> cancelled_{false};
};

/** \brief One run of what a progress stands for: at its end a cancel() is used up. One that came before
 * the run began holds too, as nobody can know from outside when it begins. */
class CancellableRun {
 public:
  explicit CancellableRun(Progress& progress) : progress_(progress) {}
  ~CancellableRun() { progress_.reset(); }
  CancellableRun(const CancellableRun&) = delete;
  CancellableRun& operator=(const CancellableRun&) = delete;

 private:
  Progress& progress_;
};

}  // namespace pcl_slim

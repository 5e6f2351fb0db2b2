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
  /** \brief Takes cancel() back, before the next run. */
  void reset() { cancelled_.store(false, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  Callback callback_;
  std::atomic<bool> cancelled_{false};
};

}  // namespace pcl_slim

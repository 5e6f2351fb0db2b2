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

  /** \brief Calls the callback, if there is one. */
  void report(float fraction, const char* stage) {
    if (callback_) callback_(fraction, stage);
  }

  /** \brief Requests that the run in progress stop, or the next one if one is expected: before the
   * first run, and from expectRun() on. Once a run has ended, nothing is there to stop until the
   * next begins. */
  void cancel() {
    State expected = State::kOpen;
    state_.compare_exchange_strong(expected, State::kCancelled);
  }
  /** \brief Takes cancel() back; the next run is expected. */
  void reset() { state_.store(State::kOpen); }
  /** \brief From now on cancel() is meant for the next run. */
  void expectRun() {
    State expected = State::kClosed;
    state_.compare_exchange_strong(expected, State::kOpen);
  }
  /** \brief Ends a run: a cancel() that came too late for it is forgotten. */
  void closeRun() { state_.store(State::kClosed); }
  /** \brief Whether the run in progress is to stop. */
  bool cancelled() const { return state_.load(std::memory_order_relaxed) == State::kCancelled; }

 private:
  enum class State { kOpen, kCancelled, kClosed };

  Callback callback_;
  std::atomic<State> state_{State::kOpen};
};

/** \brief One run of an operation with a progress. A cancel() during the run is used up at its end,
 * and one that comes after it is not kept for the next run. */
class CancellableRun {
 public:
  explicit CancellableRun(Progress& progress) : progress_(progress) { progress_.expectRun(); }
  ~CancellableRun() { progress_.closeRun(); }
  CancellableRun(const CancellableRun&) = delete;
  CancellableRun& operator=(const CancellableRun&) = delete;

 private:
  Progress& progress_;
};

}  // namespace pcl_slim

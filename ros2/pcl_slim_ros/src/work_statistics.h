// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace pcl_slim_ros {

/** \brief What a node did since it was activated. */
struct WorkCounts {
  std::uint64_t received = 0;   ///< messages
  std::uint64_t published = 0;  ///< messages
  std::uint64_t dropped = 0;    ///< messages that a newer one replaced while the node was busy
  std::uint64_t failed = 0;     ///< messages that could not be worked on
  std::uint64_t points = 0;     ///< of the messages published
  double seconds = 0;           ///< that they took
  std::uint64_t last_points = 0;
  double last_seconds = 0;
  std::string last_error, last_warning;  ///< of the last message; empty: none

  /** \brief Microseconds a point, of all messages; 0 without points. */
  double microsecondsPerPoint() const {
    return points > 0 ? 1e6 * seconds / static_cast<double>(points) : 0;
  }
  double lastMicrosecondsPerPoint() const {
    return last_points > 0 ? 1e6 * last_seconds / static_cast<double>(last_points) : 0;
  }
};

/** \brief Counts from several threads. */
class WorkStatistics {
 public:
  void reset() {
    const std::lock_guard lock(mutex_);
    counts_ = {};
  }
  void receive(bool replaced) {
    const std::lock_guard lock(mutex_);
    ++counts_.received;
    if (replaced) ++counts_.dropped;
  }
  void fail(const std::string& error) {
    const std::lock_guard lock(mutex_);
    ++counts_.failed;
    counts_.last_error = error;
    counts_.last_warning.clear();
  }
  void publish(std::uint64_t points, double seconds, const std::string& warning) {
    const std::lock_guard lock(mutex_);
    ++counts_.published;
    counts_.points += points;
    counts_.seconds += seconds;
    counts_.last_points = points;
    counts_.last_seconds = seconds;
    counts_.last_error.clear();
    counts_.last_warning = warning;
  }
  WorkCounts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  mutable std::mutex mutex_;
  WorkCounts counts_;
};

}  // namespace pcl_slim_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace pcl_slim {

/** \brief Wall time since construction, or since the last lap, in seconds. */
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  /** \brief seconds(), and begins anew. */
  double lap() {
    const double passed = seconds();
    start_ = std::chrono::steady_clock::now();
    return passed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace pcl_slim

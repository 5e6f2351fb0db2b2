// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

/** \brief Time and memory of the process, for programs that measure. */
namespace pcl_slim::measure {

/** \brief User and system time of this process so far, all threads. */
double
cpuSeconds();

double
wallSeconds();

/** \brief Middle value; the mean of the middle two; 0 of nothing. */
double
median(std::vector<double> values);

/** \brief How far the process's resident memory rises from construction on (Linux). */
class MemoryGauge {
 public:
  /** \brief Returns freed memory to the system and restarts the kernel's high-water mark. */
  MemoryGauge();

  /** \brief Highest rise so far in bytes; negative where the system does not report it. */
  double peakBytes() const;

 private:
  bool works_ = false;
  double start_ = 0;
};

/** \brief Keeps freed memory for what the process does next, as happens to whoever treats scan after
 * scan: else the allocator hands it back, now and then, and times scatter with the pages' first use.
 * Call before anything is timed. */
void
keepFreedMemory();

}  // namespace pcl_slim::measure

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

/** \brief Has the allocator keep freed memory for the process, as in a program that treats many scans: else
 * it returns memory to the system at times, and first use of new pages scatters the measured times.
 * Call before anything is timed. */
void
keepFreedMemory();

}  // namespace pcl_slim::measure

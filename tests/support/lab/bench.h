// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

/** \brief What programs that measure share: time and memory of the process, lists on the command
 * line, the choice of an instruction set. */
namespace pcl_slim::measure {

/** \brief User and system time of this process so far, all threads. */
double cpuSeconds();

double wallSeconds();

/** \brief Middle value; the mean of the middle two; 0 of nothing. */
double median(std::vector<double> values);

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

/** \brief Has the allocator keep freed memory for the process, as in a program that treats many
 * scans: else it returns memory to the system at times, and first use of new pages scatters the
 * measured times. Call before anything is timed. */
void keepFreedMemory();

/** \brief An option that takes several values, "1,2,4": one row is measured for each. */
struct ListOption {
  const char* name;
  const std::string* text;
  double low, high;  ///< allowed values, both included
  bool whole;        ///< no fractions
  std::vector<double>* values;
};

/** \brief Parses every list. \return the first mistake, naming option and remedy. */
Error parseLists(const std::vector<ListOption>& options);

/** \brief Parses "sphere,torus". \return the first name that is none. */
Error parseShapes(const std::string& text, std::vector<std::string>& names);

/** \brief Every .pcd and .ply of a folder, by name. */
Result<std::vector<std::string>> scansIn(const std::string& folder);

/** \brief Limits all kernels to one instruction set, such as "AVX2"; "best" lifts no limit.
 * \return an error that names those of this processor, if it is none of them. */
Error chooseVectors(const std::string& name);

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "scenes.h"

/** \brief What the benchmark programs share: lists on the command line, clocks, memory. */
namespace pcl_slim::bench {

/** \brief An option that takes several values, "1,2,4": one row is measured for each. */
struct ListOption {
  const char* name;
  const std::string* text;
  double low, high;  ///< allowed values, both included
  bool whole;        ///< no fractions
  std::vector<double>* values;
};

/** \brief Parses every list. \return the first mistake, naming option and remedy. */
Error
parseLists(const std::vector<ListOption>& options);

/** \brief Parses "sphere,torus". \return the first name that is none. */
Error
parseShapes(const std::string& text, std::vector<std::string>& names);

/** \brief User and system time of this process so far, all threads. */
double
cpuSeconds();

double
wallSeconds();

/** \brief Middle value; the mean of the middle two; 0 of nothing. */
double
median(std::vector<double> values);

/** \brief A scene's points as floats or doubles, with or without its normals; borrows all three. */
CloudView
viewOf(const Scene& scene, const std::vector<float>* floats, bool normals);

/** \brief How far the process's resident memory rises from construction on (Linux). */
class MemoryGauge {
 public:
  /** \brief Returns freed memory to the system and restarts the kernel's high-water mark. */
  MemoryGauge();

  /** \brief Highest rise so far in bytes; negative where the system does not tell. */
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

}  // namespace pcl_slim::bench

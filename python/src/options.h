// SPDX-License-Identifier: BSD-3-Clause
// Keyword options: those of a fit, from the table that the programs' options come from, and checks
// of others.
#pragma once

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "pcl_slim/fit/fit.h"
#include "sensor_noise.h"

namespace pcl_slim::python {

/** \brief Whose options a function takes. */
enum class FitUse : unsigned char {
  kSurface,  ///< of a fit whose surface is kept: with borders
  kPoints    ///< of one that points are projected onto
};

/** \brief The keyword arguments of one call, taken one after another. */
class Keywords {
 public:
  /** \param[in] function for sentences */
  Keywords(const char* function, const py::kwargs& given) : function_(function), given_(given) {}

  /** \brief The value of a keyword, which is then taken; None where it is not given. */
  py::object take(const char* name);
  bool takeSwitch(const char* name, bool unset);
  /** \brief A number in [low, high]; raises for others. */
  double takeNumber(const char* name, double low, double high, double unset);
  std::int64_t takeInteger(const char* name, std::int64_t low, std::int64_t high,
                           std::int64_t unset);
  /** \brief One of some words. */
  std::string takeWord(const char* name, std::initializer_list<const char*> words,
                       const char* unset);
  int takeThreads();
  /** \brief Sensors, frames and the viewpoint of a scan. */
  void takeScan(ScanArguments& scan, FitParams& params);
  /** \brief All options of a fit; those given are recorded. */
  FitParams takeFit(FitUse use);
  /** \brief The SensorNoise given to the last fit, or null. */
  const KeptNoisePointer& sensorNoise() const { return sensor_noise_; }
  /** \brief Raises for a keyword of the last fit that has no effect beside a surface. */
  void refuseWithSurface() const;
  /** \brief Raises TypeError for keywords that nobody took. */
  void finish() const;

 private:
  const char* function_;
  py::kwargs given_;
  std::vector<std::string> known_;
  KeptNoisePointer sensor_noise_;
  std::vector<std::string> only_fits_;  ///< given, and of no effect on a surface made before
};

/** \brief "-noise and -viewpoint" as Python's names: "noise and viewpoint". */
std::string withoutDashes(std::string sentence);

}  // namespace pcl_slim::python

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/stopwatch.h"

namespace pcl_slim {

/** \brief What a program did, as a JSON object with the keys every program has in common.
 *
 * program, version, input, points, threads, seconds{total, ...}, peak_rss_mb, and what the program
 * adds to json() before write().
 */
class Report {
 public:
  Report(const std::string& program, const std::string& version, const std::string& input,
         int threads);

  nlohmann::ordered_json& json() { return json_; }

  /** \brief Appends keys and values. */
  void add(const nlohmann::ordered_json& values) { json_.update(values); }

  /** \brief Notes a stage's wall time under seconds{}. */
  void time(const std::string& stage, double seconds);

  /** \brief Writes the report with the total time and peak memory; nothing for an empty path. */
  Error write(const std::string& path);

 private:
  Stopwatch total_;
  nlohmann::ordered_json json_;
};

/** \brief Highest resident memory of this process so far, in 2^20 bytes; 0 where unknown. */
double
peakMemoryMb();

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/stopwatch.h"

namespace pcl_slim {

/** \brief What a program prints while it works, in the manner of PCL's tools:
 * "> Loading scan.pcd [done, 12 ms : 34817 points]".
 *
 * On a terminal a bar shows how far a stage is. With quiet nothing is written but warnings. While it lives,
 * Ctrl-C cancels the running work through progress() (see endOnSignals()).
 */
class Console {
 public:
  explicit Console(bool quiet);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /** \brief Begins a line: "> Loading scan.pcd ". */
  void begin(const std::string& what);
  /** \brief Wall time since begin(). */
  double seconds() const { return stage_.seconds(); }
  /** \brief Ends the line: "[done, 12 ms : detail]". */
  void done(const std::string& detail) { done(seconds(), detail); }
  void done(double seconds, const std::string& detail);
  /** \brief Ends the line without success. \return the error. */
  Error failed(const Error& error);
  /** \brief A line of its own. */
  void note(const std::string& text);
  /** \brief One on stderr, also with quiet: the output is not what was hoped for. */
  void warn(const std::string& text);

  Progress& progress() { return progress_; }
  bool interrupted() const { return progress_.cancelled(); }

 private:
  void showBar(float fraction, const char* stage);
  void clearBar();

  bool quiet_, terminal_;
  int shown_percent_ = -1;
  std::string line_, shown_stage_;
  Stopwatch stage_;
  Progress progress_;
};

}  // namespace pcl_slim

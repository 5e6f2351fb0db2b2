// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/options.h"
#include "common/run_program.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief The inputs of a program that was given -out: each has its output in that folder, and is
 * worked on by a process of its own, as if it had been the only one but for OptionTable::handOn(). */
class SeveralInputs {
 public:
  explicit SeveralInputs(OptionTable& options) : options_(options) {}

  bool any() const { return !options_.inputs().empty(); }

  /** \brief Names the outputs; the first one becomes the output of the table. \return an error for
   * an option that is of one input, and for an input whose format is not written. */
  Error plan();

  /** \brief No error unless two files that are written are one, or one is an input, or an output
   * cannot be written. */
  Error check() const;

  /** \brief Works on one input after the other, hands on what OptionTable::handOn() names, and
   * writes the list of their reports where -json
   * names a file. \param[in] invoked the program as it was called */
  Exit run(const char* invoked) const;

 private:
  struct Job {
    std::string input, output;
  };

  /** \brief What one input's process leaves behind. */
  struct Left {
    std::string report;     ///< text of its report
    std::string handed_on;  ///< what it writes for the next one
  };

  int runOne(const Job& job, const char* invoked, const std::string& handed_on, Left& left) const;
  Error saveReports(const std::vector<std::string>& reports) const;

  OptionTable& options_;
  std::vector<Job> jobs_;
  std::string* report_ = nullptr;  ///< the report's file, as -json names it
};

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "benchmark/sweep_lists.h"

namespace pcl_slim::comparison {

/** \brief Which claims are measured, and on what. */
class ClaimPlan {
 public:
  /** \brief Adds the options; the plan must outlive the table's parse(). */
  void declareOptions(OptionTable& options);

  /** \brief Reads the lists given. \return the first mistake, with its remedy. */
  Error finishOptions();

  /** \brief Scenes and sweeps of the claims. */
  const SweepLists& lists() const { return lists_; }
  /** \brief Names of the claims, as claimNames() knows them. */
  const std::vector<std::string>& claims() const { return claim_list_; }
  /** \brief Files of the folder of scans, by name. */
  const std::vector<std::string>& scans() const { return scan_list_; }

 private:
  SweepLists lists_;
  std::string claims_ = "all", scans_;
  std::vector<std::string> claim_list_, scan_list_;
};

}  // namespace pcl_slim::comparison

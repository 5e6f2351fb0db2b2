// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "claims/claims.h"

namespace pcl_slim::comparison {

/** \brief What the claims share: their plan, a console that tells of each run, and their table. */
class ClaimRunner {
 public:
  ClaimRunner(const ClaimPlan& plan, Console& console, ClaimTable& table)
      : plan_(plan), console_(console), table_(table)
  {
  }

  const ClaimPlan& plan() const { return plan_; }
  const SweepLists& lists() const { return plan_.lists(); }

  /** \brief Does one piece of work, which says what came of it; not after Ctrl-C. */
  Error step(const std::string& what, const std::function<Error(std::string& detail)>& work);
  /** \brief Treats a scene; says so. */
  Result<Treated> treated(const Scene& scene, const Setting& setting);
  /** \brief Treats a scene and measures the points among which it counts (null: all judged). */
  Result<Errors> errors(const Scene& scene, const Setting& setting,
                        const std::vector<std::uint8_t>* among = nullptr);

  /** \brief Appends a figure. */
  void add(const Scene& scene, const std::string& run, const std::string& quantity, double value,
           double goal = kNone, const std::string& beside = "");

  void add(ClaimRow row) { table_.rows.push_back(std::move(row)); }

  /** \brief SLIM as it comes, with or without the scene's normals. */
  Setting slim(bool normals) const;

 private:
  const ClaimPlan& plan_;
  Console& console_;
  ClaimTable& table_;
};

/** \brief Three digits; empty for what is no number. */
std::string
shortNumber(double value);

/** \brief "relief, 0.5 % noise"; the name alone without noise. */
std::string
sceneTitle(const std::string& name, double noise);

// Claims, one function each; the table's title is theirs to set.
Error
measureRims(ClaimRunner& runner);
Error
measureNormalNoise(ClaimRunner& runner);
Error
measureZones(ClaimRunner& runner);
Error
measureSheets(ClaimRunner& runner);
Error
measureMoves(ClaimRunner& runner);
Error
measurePeers(ClaimRunner& runner);
Error
measureDefault(ClaimRunner& runner);

}  // namespace pcl_slim::comparison

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "stress/stress_cloud.h"

namespace pcl_slim_test {

/** What came of one class and one cloud. */
struct StressOutcome {
  enum class Kind : char { kResult = 'r', kRefused = 'e', kFailed = 'f', kSkipped = 's' };
  Kind kind = Kind::kSkipped;
  std::string text;  ///< the refusal's sentence, or what is wrong
};

/** The classes tried, in the order of runClasses(). */
const std::vector<const char*>& stressClasses();

/** Runs every class on a cloud: results must be finite, the same for the same points in another
 * order, repeated or among points that are nowhere, and near the truth where it is known; work
 * grows like the points. One outcome for each class. */
std::vector<StressOutcome> runClasses(const StressCloud& cloud, std::mt19937_64& random);

}  // namespace pcl_slim_test

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius_search.h"

#include "radius/rule/paper_radius_rule.h"
#include "radius/rule/penalty_radius_rule.h"
#include "radius/sparse_fallback.h"

namespace pcl_slim::detail {

RadiusSearch::RadiusSearch(const FitSettings& settings)
    : trials_(settings), tests_(trials_), final_(trials_)
{
  if (settings.paper) {
    rule_ = std::make_unique<PaperRadiusRule>(trials_);
  } else {
    rule_ = std::make_unique<PenaltyRadiusRule>(trials_, tests_);
  }
}

RadiusChoice
RadiusSearch::fallBack()
{
  return fallBackWhereSparse(trials_, tests_);
}

}  // namespace pcl_slim::detail

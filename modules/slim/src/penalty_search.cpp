// SPDX-License-Identifier: BSD-3-Clause
#include "penalty_search.h"

namespace pcl_slim {
Error
solvePenalty(const PointStore&, const FitParams&, FitSettings&, int, Progress*)
{
  return {};
}
}  // namespace pcl_slim

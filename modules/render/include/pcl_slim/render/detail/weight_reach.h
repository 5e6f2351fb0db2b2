// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Share of a ball's radius at which the blending weight has fallen to 1e-3. What is
 * beyond moves a blend by less than that share of what its leaves differ by. */
constexpr float
weightReach(WeightKernel kernel)
{
  switch (kernel) {
    case WeightKernel::kPower2: return 0.984f;  // 1 - s^2 = .0316
    case WeightKernel::kPower4: return 0.907f;  // .178
    case WeightKernel::kPower7: return 0.792f;  // .373
    default: return 0.854f;                     // 16 e^-2 (1 - s)^4
  }
}

}  // namespace pcl_slim::detail

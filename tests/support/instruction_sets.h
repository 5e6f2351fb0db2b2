// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "hwy/targets.h"

namespace pcl_slim_test {

/** \brief Runs a function once for every set of vector instructions that this processor has, the
 * kernels being dispatched to that set alone: what a processor without the newer ones would do. */
template <typename Function>
void
forEachInstructionSet(const Function& function)
{
  hwy::SetSupportedTargetsForTest(0);
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    function(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace pcl_slim_test

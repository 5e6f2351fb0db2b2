// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "hwy/targets.h"

namespace pcl_slim_test {

/** \brief Runs a function once for every set of vector instructions that this processor has, the
 * kernels being dispatched as on a processor without the newer ones: to that set, or to an older
 * one where a kernel leaves it out. */
template <typename Function>
void forEachInstructionSet(const Function& function) {
  hwy::SetSupportedTargetsForTest(0);
  // The newest has the lowest bit: what is left are it and the older ones.
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(left);
    hwy::GetChosenTarget().DeInit();
    function(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace pcl_slim_test

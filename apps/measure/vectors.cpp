// SPDX-License-Identifier: BSD-3-Clause
#include "measure/vectors.h"

#include <cstdint>

#include "hwy/targets.h"

namespace pcl_slim::measure {

Error
chooseVectors(const std::string& name)
{
  if (name == "best") return {};
  std::string known;
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    known += std::string(" ") + hwy::TargetName(target);
    if (name != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(left);  // it and older ones, for kernels that leave it out
    hwy::GetChosenTarget().DeInit();
    return {};
  }
  return {ErrorCode::kBadArgument, "this processor has no instructions '" + name +
                                       "'; give -vectors best or one of" + known};
}

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
// One target as libFuzzer wants it: PCL_SLIM_FUZZ_TARGET names it.
#include "fuzz/fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return pcl_slim_test::PCL_SLIM_FUZZ_TARGET(bytes, size);
}

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim {

Error
SplatParams::validate() const
{
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (initial_resolution < 0 || initial_resolution > RootGrid::kMaxResolution) {
    return bad("the initial resolution is 0 (automatic) to 1048576 cells along the longest side");
  }
  if (!(geometric_error >= 0.0 && std::isfinite(geometric_error))) {
    return bad("the geometric error is a finite number from 0 on");
  }
  if (!(color_error >= 0.0 && std::isfinite(color_error))) {
    return bad("the colour error is a finite number from 0 on; from 1 on colour is ignored");
  }
  if (max_depth < 0) return bad("the depth is 0 (uniform cells) or more");
  if (!(target_error >= 0.0) || std::isinf(target_error)) {
    return bad("the target error is a finite number of Delta E, 0 for none");
  }
  if (max_splats > 0 && target_error > 0) {
    return bad("a count and a target error exclude each other; set one of the two");
  }
  if (Error error = checkThreads(threads)) return error;
  if (normal_neighbors < 3) return bad("a normal needs 3 neighbours or more");
  for (const double v : viewpoint) {
    if (!std::isfinite(v)) return bad("the viewpoint is not finite; give three numbers");
  }
  return {};
}

}  // namespace pcl_slim

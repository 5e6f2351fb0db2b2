// SPDX-License-Identifier: BSD-3-Clause
#include "render/painted_errors.h"

#include "common/options.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/scan/uncertainty.h"

namespace pcl_slim {

std::string errorRangeText(const std::array<double, 2>& range) {
  return "standard error " + numberText(range[0], 3) + " to " + numberText(range[1], 3) +
         ", dark to light";
}

Result<std::array<double, 2>> paintErrors(const std::array<double, 2>& range, bool diverging,
                                          int threads, Console& console, SLIMSurface& surface) {
  const auto color = [diverging](double share) {
    return diverging ? divergingColor(2 * share - 1) : perceptualColor(share);
  };
  const auto shown = paintUncertainty(surface, range, color, threads);
  if (shown) console.note("  " + errorRangeText(*shown));
  return shown;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "color/texture_jpeg.h"

namespace pcl_slim::measure {

std::optional<std::size_t> jpegBytes(const SLIMSurface&, double) {
  return std::nullopt;
}

}  // namespace pcl_slim::measure

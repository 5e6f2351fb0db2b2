// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "pcl_slim/render/image.h"

namespace pcl_slim::test {

/** Red, green and blue of a pixel. */
inline std::array<int, 3> pixelOf(const Image& image, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

}  // namespace pcl_slim::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/render/image.h"

namespace pcl_slim::detail {

/** \brief Whether this build reads and writes PNG: png.cpp says yes, png_none.cpp no. */
bool
hasPng();

/** \brief The bytes of a PNG file, or the reason why there are none. */
Result<std::vector<std::uint8_t>>
encodePng(const Image& image);

}  // namespace pcl_slim::detail

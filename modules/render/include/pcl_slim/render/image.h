// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief A picture of 8-bit sRGB pixels, rows from the top, 3 bytes a pixel. */
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height values
};

/** \brief Writes a PNG file. It appears under its name only when complete; a failed write leaves
 * nothing behind. \return an error for an empty picture or a path that cannot be written. */
Error
savePng(const std::string& path, const Image& image);

/** \brief Reads a PNG file of any colour type as 8-bit sRGB. */
Result<Image>
loadPng(const std::string& path);

}  // namespace pcl_slim

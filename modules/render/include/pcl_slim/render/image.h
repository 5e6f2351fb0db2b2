// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief A picture of 8-bit sRGB pixels, rows from the top, 3 bytes a pixel. */
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height values
};

/** \brief Whether saveImage() writes files so named: .png (in a build with PNG) or .ppm, upper or
 * lower case; the error names those it does. */
PCL_SLIM_EXPORT Error checkImageExtension(const std::string& path);

/** \brief Writes a picture by extension. It appears under its name only when complete; a failed
 * write leaves nothing behind. \return an error for an empty picture, another extension or a path
 * that cannot be written. */
PCL_SLIM_EXPORT Error saveImage(const std::string& path, const Image& image);

/** \brief Writes a PNG file, as saveImage() does. \return also an error in a build without PNG. */
PCL_SLIM_EXPORT Error savePng(const std::string& path, const Image& image);

/** \brief The bytes of a PNG file, or the reason why there are none: a build without PNG. */
PCL_SLIM_EXPORT Result<std::vector<std::uint8_t>> encodePng(const Image& image);

/** \brief Reads a PNG file of any colour type as 8-bit sRGB. \return an error for what is no PNG
 * file, and for every file in a build without PNG. */
PCL_SLIM_EXPORT Result<Image> loadPng(const std::string& path);

}  // namespace pcl_slim

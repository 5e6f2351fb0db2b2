// SPDX-License-Identifier: BSD-3-Clause
// Replaces png.cpp in a build without libpng.
#include "image/png.h"

namespace pcl_slim {

namespace detail {

bool hasPng() {
  return false;
}

}  // namespace detail

Result<std::vector<std::uint8_t>> encodePng(const Image&) {
  return Error{ErrorCode::kBadArgument,
               "this build has no PNG (PCL_SLIM_WITH_PNG); name a .ppm file"};
}

Result<Image> loadPng(const std::string& path) {
  return Error{
      ErrorCode::kBadArgument,
      "cannot read '" + path + "': this build has no PNG (PCL_SLIM_WITH_PNG); use one that has"};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/image.h"

#include "image/png.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {
namespace {

Error checkComplete(const std::string& path, const Image& image) {
  const std::size_t expected =
      3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.width >= 1 && image.height >= 1 && image.rgb.size() == expected) return {};
  return {ErrorCode::kBadInput, "cannot write '" + path + "': the picture is empty or incomplete"};
}

/** \brief Writes a binary PPM file: a line of text, then the pixels as they are. */
Error savePpm(const std::string& path, const Image& image) {
  const std::string header =
      "P6\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n255\n";
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), image.rgb.begin(), image.rgb.end());
  return writeFile(path, bytes.data(), bytes.size());
}

}  // namespace

Error checkImageExtension(const std::string& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".ppm" || (extension == ".png" && detail::hasPng())) return {};
  if (extension == ".png") {
    return {ErrorCode::kBadArgument, "cannot write '" + path +
                                         "': this build has no PNG (PCL_SLIM_WITH_PNG); name a "
                                         ".ppm file"};
  }
  return {ErrorCode::kBadArgument, "the picture '" + path + "' must be named .png or .ppm"};
}

Error saveImage(const std::string& path, const Image& image) {
  if (Error error = checkImageExtension(path)) return error;
  if (lowerExtension(path) == ".png") return savePng(path, image);
  if (Error error = checkComplete(path, image)) return error;
  return savePpm(path, image);
}

Error savePng(const std::string& path, const Image& image) {
  if (Error error = checkComplete(path, image)) return error;
  const auto bytes = encodePng(image);
  if (!bytes) return {bytes.error().code, "cannot write '" + path + "': " + bytes.error().message};
  return writeFile(path, bytes->data(), bytes->size());
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// PNG by libpng.
#include "image/png.h"

#include <png.h>

#include <cstring>

#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace detail {

bool hasPng() {
  return true;
}

}  // namespace detail

Result<std::vector<std::uint8_t>> encodePng(const Image& image) {
  png_image header;
  std::memset(&header, 0, sizeof(header));
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    return Error{ErrorCode::kIo, header.message};
  }
  bytes.resize(size);
  return bytes;
}

Result<Image> loadPng(const std::string& path) {
  png_image header;
  std::memset(&header, 0, sizeof(header));
  header.version = PNG_IMAGE_VERSION;
  const auto bytes = readFile(path);
  if (!bytes) return bytes.error();
  if (!png_image_begin_read_from_memory(&header, bytes->data(), bytes->size())) {
    return Error{ErrorCode::kIo, "cannot read '" + path + "': " + header.message};
  }
  header.format = PNG_FORMAT_RGB;
  Image image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  if (!png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr)) {
    return Error{ErrorCode::kIo, "cannot read '" + path + "': " + header.message};
  }
  return image;
}

}  // namespace pcl_slim

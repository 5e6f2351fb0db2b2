// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "pcl_slim/stream/point_source.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kPiece = 1 << 18;  ///< points of a piece

}  // namespace

Error
CloudSource::pass(const Visit& visit)
{
  const auto at = [](const void* base, std::size_t bytes) -> const void* {
    return base ? static_cast<const char*>(base) + bytes : nullptr;
  };
  for (std::size_t first = 0; first < cloud_.count(); first += kPiece) {
    const std::size_t count = std::min(kPiece, cloud_.count() - first);
    CloudView piece = cloud_;
    if (cloud_.indices != nullptr) {
      piece.indices = cloud_.indices + first;
      piece.num_indices = count;
    } else {
      piece.xyz = at(cloud_.xyz, first * cloud_.xyz_stride);
      piece.normal = at(cloud_.normal, first * cloud_.normal_stride);
      piece.size = count;
    }
    if (Error error = visit(piece)) return error;
  }
  return {};
}

}  // namespace pcl_slim

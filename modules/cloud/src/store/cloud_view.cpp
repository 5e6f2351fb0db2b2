// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/cloud_view.h"

#include <cstring>
#include <string>

namespace pcl_slim {

namespace {

constexpr std::size_t kTooMany =
    0xffffffffu;  ///< points are counted in 32 bits, one number is spare

}  // namespace

std::array<double, 3>
CloudView::placeAt(const void* first, std::size_t offset, Scalar scalar)
{
  const char* at = static_cast<const char*>(first) + offset;
  std::array<double, 3> place{};
  if (scalar == Scalar::kDouble) {
    std::memcpy(place.data(), at, sizeof(place));
  } else {
    std::array<float, 3> narrow{};
    std::memcpy(narrow.data(), at, sizeof(narrow));
    place = {narrow[0], narrow[1], narrow[2]};
  }
  return place;
}

std::array<float, 3>
CloudView::givenNormal(std::size_t input) const
{
  std::array<float, 3> given{};
  std::memcpy(given.data(), static_cast<const char*>(normal) + input * normal_stride,
              sizeof(given));
  return given;
}

Error
CloudView::validate() const
{
  const std::size_t n = count();
  if (n == 0 || xyz == nullptr) return badInput("the cloud has no points: give one that has");
  if (n >= kTooMany) return badInput("the cloud has more than 2^32 - 2 points: split it");
  for (std::size_t i = 0; indices != nullptr && i < n; ++i) {
    if (indices[i] < 0 || static_cast<std::size_t>(indices[i]) >= size) {
      return {ErrorCode::kBadArgument, "index " + std::to_string(indices[i]) +
                                           " lies outside the cloud of " + std::to_string(size) +
                                           " points"};
    }
  }
  return {};
}

Error
CloudView::nothingFinite()
{
  return badInput("every point of the cloud is NaN or infinite: nothing to work on");
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surfel_color.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim {

void
encodeColor(const ColorPolynomial& color, std::uint8_t* bytes)
{
  for (std::size_t k = 0; k < color.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = color[k][c];
      const long code = k == 0 ? std::lround(std::clamp(value, 0.0f, 255.0f))
                               : std::lround(std::clamp(value / kColorStep, -127.0f, 127.0f));
      bytes[3 * k + c] = static_cast<std::uint8_t>(code);
    }
  }
}

ColorPolynomial
decodeColor(const std::uint8_t* bytes)
{
  ColorPolynomial color;
  for (std::size_t k = 0; k < color.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t code = bytes[3 * k + c];
      color[k][c] = k == 0 ? static_cast<float>(code)
                           : kColorStep * static_cast<float>(static_cast<std::int8_t>(code));
    }
  }
  return color;
}

void
flipColor(std::uint8_t* bytes)
{
  for (int n = 1, k = 1; n <= kColorDegree; ++n) {
    for (int power_of_v = 0; power_of_v <= n; ++power_of_v, ++k) {
      for (int c = 0; power_of_v % 2 != 0 && c < 3; ++c) {
        std::uint8_t& code = bytes[3 * k + c];
        code = static_cast<std::uint8_t>(-static_cast<std::int8_t>(code));
      }
    }
  }
}

}  // namespace pcl_slim

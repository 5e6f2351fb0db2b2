// SPDX-License-Identifier: BSD-3-Clause
// Texels as files and pages code them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace pcl_slim::detail {

constexpr int kMostColorError = 32;  ///< of a channel

/** \brief A texel, rounded to steps of 2 color_error + 1, as luma and two differences, each modulo
 * 256 and so reversible: YCoCg-R (Malvar, Sullivan 2003). */
struct LumaTexel {
  std::array<std::uint8_t, 3> value{};  ///< the differences are signed bytes
  int size = 0;                         ///< of what prediction left

  LumaTexel() = default;
  LumaTexel(const std::uint8_t* rgb, int color_error) {
    const int step = 2 * color_error + 1;
    const int red = (rgb[0] + color_error) / step, green = (rgb[1] + color_error) / step,
              blue = (rgb[2] + color_error) / step;
    const int orange = signedByte(red - blue), base = (blue + (orange >> 1)) & 255;
    const int from_base = signedByte(green - base);
    value = {byteOf(base + (from_base >> 1)), byteOf(orange), byteOf(from_base)};
  }

  /** \brief Sets red, green and blue, none farther than color_error from what they were. */
  void setRgb(int color_error, std::uint8_t* rgb) const {
    const int step = 2 * color_error + 1, orange = signedByte(value[1]),
              from_base = signedByte(value[2]);
    const int base = value[0] - (from_base >> 1), blue = base - (orange >> 1);
    const std::array<int, 3> steps = {blue + orange, base + from_base, blue};
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = static_cast<std::uint8_t>(std::min(byteOf(steps[c]) * step, 255));
  }

  /** \brief Predicted from the texels to its left, below and between these: the median of the first
   * two and of their plane (LOCO-I; Weinberger, Seroussi, Sapiro 2000). */
  static LumaTexel predicted(const LumaTexel& left, const LumaTexel& below,
                             const LumaTexel& corner) {
    LumaTexel texel;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = left.number(c), b = below.number(c), d = corner.number(c);
      texel.value[c] = byteOf(std::clamp(a + b - d, std::min(a, b), std::max(a, b)));
    }
    return texel;
  }

  /** \brief What a prediction leaves of a channel, -128 ... 127. */
  int residual(const LumaTexel& predicted, std::size_t channel) const {
    return signedByte(value[channel] - predicted.value[channel]);
  }

  static std::uint8_t byteOf(int number) { return static_cast<std::uint8_t>(number); }

 private:
  static int signedByte(int number) { return static_cast<std::int8_t>(byteOf(number)); }
  int number(std::size_t channel) const {
    return channel == 0 ? value[0] : signedByte(value[channel]);
  }
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "file/surfel_codec.h"
#include "pcl_slim/surface/surfel_texture.h"

namespace pcl_slim::detail {

/** \brief Codes textures one after another, in either direction (surfel_codec.h).
 *
 * Channels are rounded to steps and become a luma and two differences, reversibly (YCoCg-R; Malvar,
 * Sullivan 2003). Each is predicted by the median of the texels to the left and below and of their
 * plane (LOCO-I; Weinberger, Seroussi, Sapiro 2000). Texels that are as predicted take one bit,
 * whose chance depends on those around.
 */
template <typename Coder>
class TextureCodec {
 public:
  /** \param[in] color_error greatest error of a channel */
  TextureCodec(Coder& coder, int color_error) : coder_(coder), step_(2 * color_error + 1) {}

  /** \brief \param[in,out] side 0: there is none \param[in,out] rgb numBytes(side) */
  void code(int& side, std::vector<std::uint8_t>& rgb) {
    const std::int64_t change = side_.code(coder_, side - last_);
    side = last_ = std::clamp(last_ + static_cast<int>(std::clamp<std::int64_t>(change, -255, 255)),
                              0, SurfelTexture::kMostSide);
    rgb.resize(SurfelTexture::numBytes(side));
    texels_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), {});
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) codeTexel(side, column, row, rgb);
  }

 private:
  struct Texel {
    std::array<int, 3> value{};  ///< luma and differences
    int size = 0;                ///< of what prediction left
  };

  void codeTexel(int side, int column, int row, std::vector<std::uint8_t>& rgb) {
    const auto at = static_cast<std::size_t>(row * side + column);
    const Texel none;
    const Texel& left = column > 0 ? texels_[at - 1] : none;
    const Texel& below = row > 0 ? texels_[at - static_cast<std::size_t>(side)] : none;
    const Texel& corner =
        column > 0 && row > 0 ? texels_[at - static_cast<std::size_t>(side) - 1] : none;
    const std::array<int, 3> predicted = predict(column, row, left, below, corner);
    const std::array<int, 3> value = lumaOf(rgb.data() + 3 * at);
    const int around = left.size + below.size;
    Texel& texel = texels_[at];
    const std::size_t context = around == 0 ? 0 : around < 3 ? 1 : around < 9 ? 2 : 3;
    const std::size_t quiet =
        (left.size == 0 ? 1 : 0) + (below.size == 0 ? 2 : 0) + (corner.size == 0 ? 4 : 0);
    texel.value = predicted;
    if (!coder_.bit(predicted_[quiet], value == predicted)) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int64_t rest = rests_[c][context].code(coder_, value[c] - predicted[c]);
        const auto bounded = static_cast<int>(std::clamp<std::int64_t>(rest, -1024, 1024));
        texel.value[c] += bounded;
        texel.size += std::abs(bounded);
      }
    }
    setRgb(texel.value, rgb.data() + 3 * at);
  }

  static std::array<int, 3> predict(int column, int row, const Texel& left, const Texel& below,
                                    const Texel& corner) {
    if (row == 0) return left.value;
    if (column == 0) return below.value;
    std::array<int, 3> predicted;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = left.value[c], b = below.value[c], d = corner.value[c];
      predicted[c] = std::clamp(a + b - d, std::min(a, b), std::max(a, b));
    }
    return predicted;
  }

  std::array<int, 3> lumaOf(const std::uint8_t* rgb) const {
    const int half = step_ / 2, r = (rgb[0] + half) / step_, g = (rgb[1] + half) / step_,
              b = (rgb[2] + half) / step_;
    const int orange = r - b, base = b + (orange >> 1), green = g - base;
    return {base + (green >> 1), orange, green};
  }

  void setRgb(const std::array<int, 3>& value, std::uint8_t* rgb) const {
    const int base = value[0] - (value[2] >> 1), green = value[2] + base,
              blue = base - (value[1] >> 1), red = blue + value[1];
    const auto byteOf = [&](int steps) {
      return static_cast<std::uint8_t>(std::clamp(steps * step_, 0, 255));
    };
    rgb[0] = byteOf(red);
    rgb[1] = byteOf(green);
    rgb[2] = byteOf(blue);
  }

  Coder& coder_;
  int step_, last_ = 0;
  std::vector<Texel> texels_;
  NumberModel side_;
  std::array<BitModel, 8> predicted_;
  std::array<std::array<NumberModel, 4>, 3> rests_;
};

}  // namespace pcl_slim::detail

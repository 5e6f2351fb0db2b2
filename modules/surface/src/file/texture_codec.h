// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "file/surfel_codec.h"
#include "pcl_slim/surface/detail/luma_texel.h"
#include "pcl_slim/surface/surfel_texture.h"

namespace pcl_slim::detail {

/** \brief Codes textures one after another, in either direction (surfel_codec.h): what prediction
 * leaves of luma and differences. Texels that are as predicted take one bit, whose chance depends on
 * those around. */
template <typename Coder>
class TextureCodec {
 public:
  /** \param[in] color_error greatest error of a channel */
  TextureCodec(Coder& coder, int color_error) : coder_(coder), color_error_(color_error) {}

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
  void codeTexel(int side, int column, int row, std::vector<std::uint8_t>& rgb) {
    const auto at = static_cast<std::size_t>(row * side + column);
    const LumaTexel none;
    const LumaTexel& left = column > 0 ? texels_[at - 1] : none;
    const LumaTexel& below = row > 0 ? texels_[at - static_cast<std::size_t>(side)] : none;
    const LumaTexel& corner =
        column > 0 && row > 0 ? texels_[at - static_cast<std::size_t>(side) - 1] : none;
    LumaTexel predicted = row == 0 ? left : below;
    if (row > 0 && column > 0) predicted = LumaTexel::predicted(left, below, corner);
    const LumaTexel own(rgb.data() + 3 * at, color_error_);
    const int around = left.size + below.size;
    const std::size_t context = around == 0 ? 0 : around < 3 ? 1 : around < 9 ? 2 : 3;
    const std::size_t quiet =
        (left.size == 0 ? 1 : 0) + (below.size == 0 ? 2 : 0) + (corner.size == 0 ? 4 : 0);
    LumaTexel& texel = texels_[at];
    texel.value = predicted.value;
    if (!coder_.bit(predicted_[quiet], own.value == predicted.value)) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int64_t rest = rests_[c][context].code(coder_, own.residual(predicted, c));
        texel.value[c] = LumaTexel::byteOf(predicted.value[c] + static_cast<int>(rest & 255));
        texel.size += std::abs(texel.residual(predicted, c));
      }
    }
    texel.setRgb(color_error_, rgb.data() + 3 * at);
  }

  Coder& coder_;
  int color_error_, last_ = 0;
  std::vector<LumaTexel> texels_;
  NumberModel side_;
  std::array<BitModel, 8> predicted_;
  std::array<std::array<NumberModel, 4>, 3> rests_;
};

}  // namespace pcl_slim::detail

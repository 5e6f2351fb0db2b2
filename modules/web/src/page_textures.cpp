// SPDX-License-Identifier: BSD-3-Clause
#include "page_textures.h"

#include <algorithm>
#include <cstdlib>

namespace pcl_slim::detail {

namespace {

int signedByte(int value) {
  return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
}

/** Differences count from -128 on. */
int numberOf(const LumaTexel& texel, std::size_t channel) {
  return channel == 0 ? texel.value[0] : signedByte(texel.value[channel]);
}

/** Whether no place of a texture's disc takes its colour from a texel. */
bool isOutsideDisc(int side, int column, int row) {
  // A texel colours places less than a texel from its middle along either axis.
  const auto gap = [&](int k) { return std::max(std::abs(2 * k + 1 - side) - 2, 0); };
  return gap(column) * gap(column) + gap(row) * gap(row) >= side * side;
}

}  // namespace

LumaTexel LumaTexel::of(const std::array<int, 3>& rgb) {
  const int orange = signedByte(rgb[0] - rgb[2]), base = (rgb[2] + (orange >> 1)) & 255;
  const int green = signedByte(rgb[1] - base);
  LumaTexel texel;
  texel.value = {static_cast<std::uint8_t>(base + (green >> 1)), static_cast<std::uint8_t>(orange),
                 static_cast<std::uint8_t>(green)};
  return texel;
}

std::array<int, 3> LumaTexel::rgb() const {
  const int orange = signedByte(value[1]), green = signedByte(value[2]);
  const int base = value[0] - (green >> 1), blue = base - (orange >> 1);
  return {(blue + orange) & 255, (base + green) & 255, blue & 255};
}

TexelContext contextOf(const std::vector<LumaTexel>& texels, int side, int column, int row,
                       const LumaTexel& first) {
  const auto at = static_cast<std::size_t>(row * side + column),
             below = at - static_cast<std::size_t>(side);
  TexelContext context;
  context.stored = !isOutsideDisc(side, column, row);
  LumaTexel& predicted = context.predicted;
  predicted = row > 0 ? texels[below] : column > 0 ? texels[at - 1] : first;
  predicted.size = 0;
  if (row == 0 || !context.stored) return context;
  int around = texels[below].size;
  if (column + 1 < side) around += texels[below + 1].size;
  if (column > 0) {
    const LumaTexel &left = texels[at - 1], &corner = texels[below - 1];
    around += left.size + corner.size;
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = numberOf(left, c), b = numberOf(texels[below], c), d = numberOf(corner, c);
      predicted.value[c] =
          static_cast<std::uint8_t>(std::clamp(a + b - d, std::min(a, b), std::max(a, b)));
    }
  }
  for (const int least : {1, 3, 6, 12, 24, 48}) context.plane += around >= least;
  return context;
}

LumaTexel TexturePacker::rounded(const std::uint8_t* rgb) const {
  const int step = 2 * color_error_ + 1;
  std::array<int, 3> steps;
  for (std::size_t c = 0; c < 3; ++c) steps[c] = (rgb[c] + color_error_) / step;
  return LumaTexel::of(steps);
}

void TexturePacker::add(int side, const std::uint8_t* rgb, const std::uint8_t* first) {
  sides_.push_back(static_cast<std::uint32_t>(side));
  texels_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), {});
  const LumaTexel begin = rounded(first);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto at = static_cast<std::size_t>(row * side + column);
      const TexelContext context = contextOf(texels_, side, column, row, begin);
      LumaTexel& texel = texels_[at];
      texel = context.predicted;
      if (!context.stored) continue;
      texel = rounded(rgb + 3 * at);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto residual =
            static_cast<unsigned char>(texel.value[c] - context.predicted.value[c]);
        planes_[c][context.plane].push_back(residual);
        texel.size += std::abs(signedByte(residual));
      }
    }
  }
}

void TexturePacker::write(PlaneWriter& out) const {
  out.put({static_cast<std::uint32_t>(color_error_)}, 1);
  out.put(sides_, 1);
  std::vector<std::uint32_t> counts;
  for (const auto& plane : planes_[0]) counts.push_back(static_cast<std::uint32_t>(plane.size()));
  out.put(counts, 4);
  for (const auto& channel : planes_) {
    for (const auto& plane : channel) out.data.insert(out.data.end(), plane.begin(), plane.end());
  }
}

}  // namespace pcl_slim::detail

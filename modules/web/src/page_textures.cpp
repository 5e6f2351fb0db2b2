// SPDX-License-Identifier: BSD-3-Clause
#include "page_textures.h"

#include <algorithm>
#include <cstdlib>

namespace pcl_slim::detail {

namespace {

/** Whether no place of a texture's disc takes its colour from a texel. */
bool isOutsideDisc(int side, int column, int row) {
  // A texel colours places less than a texel from its middle along either axis.
  const auto gap = [&](int k) { return std::max(std::abs(2 * k + 1 - side) - 2, 0); };
  return gap(column) * gap(column) + gap(row) * gap(row) >= side * side;
}

}  // namespace

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
    predicted = LumaTexel::predicted(left, texels[below], corner);
  }
  for (const int least : {1, 3, 6, 12, 24, 48}) context.plane += around >= least;
  return context;
}

void TexturePacker::add(int side, const std::uint8_t* rgb, const std::uint8_t* first) {
  sides_.push_back(static_cast<std::uint32_t>(side));
  texels_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), {});
  const LumaTexel begin(first, color_error_);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto at = static_cast<std::size_t>(row * side + column);
      const TexelContext context = contextOf(texels_, side, column, row, begin);
      LumaTexel& texel = texels_[at];
      texel = context.predicted;
      if (!context.stored) continue;
      texel = LumaTexel(rgb + 3 * at, color_error_);
      for (std::size_t c = 0; c < 3; ++c) {
        const int residual = texel.residual(context.predicted, c);
        planes_[c][context.plane].push_back(LumaTexel::byteOf(residual));
        texel.size += std::abs(residual);
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

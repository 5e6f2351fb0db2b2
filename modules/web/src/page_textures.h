// SPDX-License-Identifier: BSD-3-Clause
// How a page packs textures of surfels. web/textures.js reads them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "page_columns.h"
#include "pcl_slim/surface/detail/luma_texel.h"
#include "pcl_slim/surface/surfel_texture.h"

namespace pcl_slim::detail {

constexpr std::size_t kTexelPlanes = 7;  ///< of residuals, for each channel

/** \brief What is known of a texel before it is read. */
struct TexelContext {
  LumaTexel predicted;
  std::size_t plane = 0;  ///< residuals of texels with like neighbours are neighbours
  bool stored = true;     ///< otherwise no place of the disc takes its colour from the texel
};

/** \brief \param[in] texels of the texture, row by row, up to this one
 * \param[in] first predicts the first one */
TexelContext contextOf(const std::vector<LumaTexel>& texels, int side, int column, int row,
                       const LumaTexel& first);

/** \brief The texture of one surfel after another: a residual takes a byte, in the plane of its channel
 * and context. */
class TexturePacker {
 public:
  explicit TexturePacker(int color_error) : color_error_(color_error) {}

  /** \param[in] rgb its texels \param[in] first colour from which the first texel differs */
  void add(int side, const std::uint8_t* rgb, const std::uint8_t* first);
  void write(PlaneWriter& out) const;

 private:
  int color_error_;
  std::vector<std::uint32_t> sides_;
  std::array<std::array<std::vector<unsigned char>, kTexelPlanes>, 3> planes_;
  std::vector<LumaTexel> texels_;
};

}  // namespace pcl_slim::detail

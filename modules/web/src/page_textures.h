// SPDX-License-Identifier: BSD-3-Clause
// How a page packs textures of surfels. web/textures.js reads them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "page_columns.h"
#include "pcl_slim/surface/surfel_texture.h"

namespace pcl_slim::detail {

constexpr int kMostColorError = 32;  ///< of a channel of a texel

/** \brief A texel as luma and two differences, each modulo 256: YCoCg-R (Malvar, Sullivan 2003). */
struct LumaTexel {
  std::array<std::uint8_t, 3> value{};  ///< the differences are signed bytes
  int size = 0;                         ///< of what prediction left

  static LumaTexel of(const std::array<int, 3>& rgb);
  std::array<int, 3> rgb() const;
};

constexpr std::size_t kTexelPlanes = 7;  ///< of residuals, for each channel

/** \brief What is known of a texel before it is read. */
struct TexelContext {
  LumaTexel predicted;    ///< by the texels to the left and below (LOCO-I)
  std::size_t plane = 0;  ///< residuals of texels with like neighbours are neighbours
  bool stored = true;     ///< otherwise no place of the disc takes its colour from the texel
};

/** \brief \param[in] texels of the texture, row by row, up to this one
 * \param[in] first predicts the first one */
TexelContext contextOf(const std::vector<LumaTexel>& texels, int side, int column, int row,
                       const LumaTexel& first);

/** \brief The texture of one surfel after another.
 *
 * Channels are rounded to steps of 2 color_error + 1 and become a luma and two differences; each is
 * predicted. A residual takes a byte, in the plane of its channel and context.
 */
class TexturePacker {
 public:
  explicit TexturePacker(int color_error) : color_error_(color_error) {}

  /** \param[in] rgb its texels \param[in] first colour from which the first texel differs */
  void add(int side, const std::uint8_t* rgb, const std::uint8_t* first);
  void write(PlaneWriter& out) const;

 private:
  LumaTexel rounded(const std::uint8_t* rgb) const;

  int color_error_;
  std::vector<std::uint32_t> sides_;
  std::array<std::array<std::vector<unsigned char>, kTexelPlanes>, 3> planes_;
  std::vector<LumaTexel> texels_;
};

}  // namespace pcl_slim::detail

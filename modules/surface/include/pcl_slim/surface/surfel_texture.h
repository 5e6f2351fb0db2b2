// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace pcl_slim {

/** \brief The colours of a surfel where a polynomial (surfel_color.h) does not follow them: side x
 * side texels over the square of its (u, v) plane that contains the disc of kReach radii.
 *
 * Texels are red, green and blue, row by row from the least v up, each row from the least u up.
 * Colours between their middles are bilinear. A texture refers to memory of its surface.
 */
struct SurfelTexture {
  static constexpr int kMostSide = 255;
  /** \brief [radii] Leaves cover points up to here, so that there is a texture at every point. */
  static constexpr float kReach = 2.0f / 3.0f;

  int side = 0;  ///< 0: the surfel has none
  const std::uint8_t* rgb = nullptr;

  bool empty() const { return side == 0; }
  const std::uint8_t* at(int column, int row) const { return rgb + 3 * (row * side + column); }

  /** \brief Bytes that the texels take. */
  static constexpr std::size_t numBytes(int side) {
    return 3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  }

  /** \brief The colour at a place of the plane, in units of the radius; 0..255 is the range of
   * colours. O(1). */
  std::array<float, 3> colorAt(float u, float v) const {
    const auto last = static_cast<float>(side - 1);
    const float half = 0.5f * static_cast<float>(side);
    const float x = std::min(std::max(half * (u / kReach + 1.0f) - 0.5f, 0.0f), last),
                y = std::min(std::max(half * (v / kReach + 1.0f) - 0.5f, 0.0f), last);
    const int column = std::min(static_cast<int>(x), std::max(side - 2, 0)),
              row = std::min(static_cast<int>(y), std::max(side - 2, 0));
    const float right = x - static_cast<float>(column), up = y - static_cast<float>(row);
    const std::uint8_t *low = at(column, row), *high = side > 1 ? low + 3 * side : low;
    const int next = side > 1 ? 3 : 0;
    std::array<float, 3> color;
    for (int c = 0; c < 3; ++c) {
      const float a = low[c], b = low[c + next], d = high[c], e = high[c + next];
      const float below = a + right * (b - a), above = d + right * (e - d);
      color[static_cast<std::size_t>(c)] = below + up * (above - below);
    }
    return color;
  }

  /** \brief The mean colour over a square of the plane about a place, of up to kMostTaps x kMostTaps
   * places in it: what a pixel shows that is wider than texels. \param[in] width [radii] */
  std::array<float, 3> meanAt(float u, float v, float width) const {
    const float texels = 0.5f * static_cast<float>(side) * width / kReach;
    const int taps = texels < 1.5f ? 1 : std::min(static_cast<int>(texels + 0.5f), kMostTaps);
    if (taps == 1) return colorAt(u, v);
    const float step = width / static_cast<float>(taps), first = 0.5f * (step - width);
    std::array<float, 3> sum{};
    for (int row = 0; row < taps; ++row) {
      for (int column = 0; column < taps; ++column) {
        const auto color = colorAt(u + first + step * static_cast<float>(column),
                                   v + first + step * static_cast<float>(row));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += color[c];
      }
    }
    for (float& value : sum) value /= static_cast<float>(taps * taps);
    return sum;
  }
  static constexpr int kMostTaps = 4;

  /** \brief The weight of a leaf's colour at a squared distance from its centre [radii], where a
   * surface has textures: the nearest leaf's counts most, so that textures do not blur each other.
   * \param[in] blend the kernel's there, which decides beyond the textures */
  static float weight(float s_sq, float blend) {
    const float inner = std::max(1.0f - s_sq / (kReach * kReach), 0.0f);
    const float square = inner * inner, fourth = square * square;
    return fourth * fourth + kOuterWeight * blend;
  }
  static constexpr float kOuterWeight = 1e-4f;
};

}  // namespace pcl_slim

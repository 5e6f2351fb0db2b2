// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief What a colour's three numbers mean. */
enum class RgbSpace : unsigned char {
  kSrgb,  ///< IEC 61966-2-1: gamma-coded, linearised before use (the default)
  kEbu    ///< EBU primaries, numbers taken as linear: what the colour splat paper computes
};

/** \brief CIELAB under D65, L* in [0, 100]. White has a* = b* = 0 exactly up to rounding.
 * \param[in] rgb red, green, blue in [0, 1]. */
PCL_SLIM_EXPORT std::array<double, 3> labFromRgb(const std::array<double, 3>& rgb,
                                                 RgbSpace space = RgbSpace::kSrgb);

/** \brief The inverse. Colours outside the gamut come out clamped to [0, 1]. */
PCL_SLIM_EXPORT std::array<double, 3> rgbFromLab(const std::array<double, 3>& lab,
                                                 RgbSpace space = RgbSpace::kSrgb);

/** \brief Conversion of 8-bit colours by tables, a fraction of the exact one's cost.
 *
 * The cube root comes from 4096 straight pieces. 10 KB of tables; safe to share between threads.
 */
class PCL_SLIM_EXPORT LabTable {
 public:
  static constexpr double kMaxDeltaE = 0.004;  ///< distance from labFromRgb, over all colours

  explicit LabTable(RgbSpace space = RgbSpace::kSrgb);

  /** \brief \param[out] lab L*, a*, b*. */
  void convert(std::uint8_t red, std::uint8_t green, std::uint8_t blue, float lab[3]) const {
    const float r = linear_[red], g = linear_[green], b = linear_[blue];
    const float fx = root(to_x_[0] * r + to_x_[1] * g + to_x_[2] * b);
    const float fy = root(to_y_[0] * r + to_y_[1] * g + to_y_[2] * b);
    const float fz = root(to_z_[0] * r + to_z_[1] * g + to_z_[2] * b);
    lab[0] = 116.0f * fy - 16.0f;
    lab[1] = 500.0f * (fx - fy);
    lab[2] = 200.0f * (fy - fz);
  }

  /** \brief Linear share of one channel's byte, in [0, 1]. */
  float linear(std::uint8_t byte) const { return linear_[byte]; }

  /** \brief CIELAB of n colours in place: columns contain linear() of red, green and blue before,
   * L*, a* and b* after. Within kMaxDeltaE of labFromRgb; a fifth of convert()'s cost. The columns
   * have room for a multiple of 16 numbers and start at 64 bytes. */
  void labOfLinear(float* r, float* g, float* b, std::size_t n) const;

  /** \brief Nearest 8-bit colour of the gamut's part around lab; channels are clamped. At most one
   * step compared with rgbFromLab. */
  std::array<std::uint8_t, 3> rgb(const float lab[3]) const;

  /** \brief The same in [0, 255] without rounding. */
  std::array<float, 3> rgbUnrounded(const float lab[3]) const;

 private:
  static constexpr int kPieces = 4096;

  float root(float q) const {
    const float at = q * static_cast<float>(kPieces);
    const int piece = at < static_cast<float>(kPieces - 1) ? static_cast<int>(at) : kPieces - 1;
    const auto i = static_cast<std::size_t>(piece);
    return root_[i] + (at - static_cast<float>(piece)) * (root_[i + 1] - root_[i]);
  }

  std::array<float, 256> linear_;
  std::array<float, 3> to_x_, to_y_, to_z_;  ///< rows of RGB -> XYZ over the white point
  std::array<std::array<float, 3>, 3> from_xyz_;
  std::array<float, kPieces + 1> root_, coded_;
};

}  // namespace pcl_slim

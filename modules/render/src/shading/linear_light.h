// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pcl_slim/render/color_map.h"

namespace pcl_slim::detail {

/** \brief sRGB channel to linear light, both in [0, 1]. */
inline float
toLinear(float s)
{
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

inline Color
toLinear(const Color& s)
{
  return {toLinear(s[0]), toLinear(s[1]), toLinear(s[2])};
}

/** \brief Linear light to an 8-bit sRGB channel. */
inline std::uint8_t
toByte(float linear)
{
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float s = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * s));
}

}  // namespace pcl_slim::detail

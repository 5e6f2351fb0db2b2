// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pcl_slim/core/srgb.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim::detail {

inline Color
toLinear(const Color& s)
{
  return {linearFromSrgb(s[0]), linearFromSrgb(s[1]), linearFromSrgb(s[2])};
}

/** \brief Linear light of an empty pixel: white, or a grey that darkens downwards. */
inline Color
backgroundAt(const ShadingParams& params, int y, int height)
{
  if (!params.gradient_background) return {1.0f, 1.0f, 1.0f};
  const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
  const float level = 0.985f - 0.145f * t * t;
  return toLinear({level, level, level + 0.006f});
}

/** \brief Linear light to an 8-bit sRGB channel. */
inline std::uint8_t
toByte(float linear)
{
  const float s = srgbFromLinear(std::clamp(linear, 0.0f, 1.0f));
  return static_cast<std::uint8_t>(std::lround(255.0f * s));
}

}  // namespace pcl_slim::detail

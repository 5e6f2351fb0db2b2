// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace pcl_slim {

/** \brief Linear light of an sRGB channel, both in [0, 1] (IEC 61966-2-1). T: float or double. */
template <typename T>
T linearFromSrgb(T s) {
  return s <= T(0.04045) ? s / T(12.92) : std::pow((s + T(0.055)) / T(1.055), T(2.4));
}

/** \brief The inverse of linearFromSrgb(). */
template <typename T>
T srgbFromLinear(T x) {
  return x <= T(0.0031308) ? T(12.92) * x : T(1.055) * std::pow(x, T(1) / T(2.4)) - T(0.055);
}

}  // namespace pcl_slim

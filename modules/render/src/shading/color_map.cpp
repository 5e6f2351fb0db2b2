// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/color_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcl_slim {
namespace {

/** \brief Linear interpolation in a table of evenly spaced colours, x in [0, 1]. */
template <std::size_t N>
Color
interpolate(const std::array<Color, N>& table, double x)
{
  const double position = std::clamp(std::isnan(x) ? 0.0 : x, 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(position), N - 2);
  const auto t = static_cast<float>(position - static_cast<double>(i));
  Color color;
  for (std::size_t k = 0; k < 3; ++k) color[k] = table[i][k] + t * (table[i + 1][k] - table[i][k]);
  return color;
}

}  // namespace

Color
divergingColor(double x)
{
  static constexpr std::array<Color, 7> kTable{{{0.10f, 0.20f, 0.56f},
                                                {0.22f, 0.46f, 0.80f},
                                                {0.60f, 0.76f, 0.92f},
                                                {0.93f, 0.92f, 0.90f},
                                                {0.97f, 0.70f, 0.54f},
                                                {0.84f, 0.33f, 0.25f},
                                                {0.52f, 0.06f, 0.14f}}};
  return interpolate(kTable, 0.5 + 0.5 * x);
}

Color
perceptualColor(double x)
{
  // Lightness rises evenly from 15 to 91 (CIE L*).
  static constexpr std::array<Color, 7> kTable{{{0.16f, 0.08f, 0.36f},
                                                {0.18f, 0.25f, 0.51f},
                                                {0.14f, 0.41f, 0.55f},
                                                {0.12f, 0.55f, 0.53f},
                                                {0.31f, 0.69f, 0.42f},
                                                {0.65f, 0.80f, 0.27f},
                                                {0.98f, 0.90f, 0.35f}}};
  return interpolate(kTable, x);
}

Color
sizeColor(double x)
{
  static constexpr std::array<Color, 5> kTable{{{0.80f, 0.16f, 0.15f},
                                                {0.95f, 0.62f, 0.22f},
                                                {0.88f, 0.86f, 0.52f},
                                                {0.40f, 0.70f, 0.62f},
                                                {0.18f, 0.34f, 0.70f}}};
  return interpolate(kTable, x);
}

Color
categoryColor(std::uint32_t category)
{
  static constexpr std::array<Color, 10> kTable{{{0.27f, 0.47f, 0.72f},
                                                 {0.93f, 0.55f, 0.24f},
                                                 {0.36f, 0.66f, 0.38f},
                                                 {0.82f, 0.30f, 0.32f},
                                                 {0.57f, 0.44f, 0.73f},
                                                 {0.58f, 0.43f, 0.36f},
                                                 {0.88f, 0.52f, 0.74f},
                                                 {0.52f, 0.54f, 0.56f},
                                                 {0.74f, 0.73f, 0.28f},
                                                 {0.28f, 0.71f, 0.78f}}};
  return kTable[category % kTable.size()];
}

}  // namespace pcl_slim

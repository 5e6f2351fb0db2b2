// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pcl_slim/web/web_surface.h"

namespace pcl_slim::detail {

/** \brief encodeWebSurface() before it is deflated. The surface must pass validate(). */
std::vector<unsigned char>
packColumns(const SLIMSurface& surface, double precision);

/** \brief Inverse of packColumns(). */
Result<WebSurface>
unpackColumns(const std::vector<unsigned char>& bytes);

constexpr double kCenterSteps = 65535.0;  ///< along the longest side of the centres' box
constexpr double kNormalGrid = 2047.0;    ///< steps of a coordinate to each side: 12 bits
constexpr std::uint32_t kEscape = 255;    ///< marks a coefficient with a three-byte code
constexpr double kMostSteps =
    8388607.0;  ///< largest number of steps that a three-byte code can represent

inline std::uint32_t
bitsOf(float value)
{
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

inline float
floatOf(std::uint32_t bits)
{
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/** \brief A coordinate of a normal's octahedral code as a number from 0 on, and back. */
inline std::uint32_t
gridCode(float coordinate)
{
  return static_cast<std::uint32_t>(std::lround((coordinate + 1.0) * kNormalGrid));
}

inline float
gridCoordinate(std::uint32_t code)
{
  return static_cast<float>(code / kNormalGrid - 1.0);
}

/** \brief Steps per radius of coefficient k. The constant one moves the surface as a whole; steps of large
 * balls are as long as those of balls of kLargeBall diagonals. */
inline double
stepsOf(double precision, std::size_t k, double diagonals)
{
  constexpr double kLargeBall = 0.02;
  return (k == 0 ? 4.0 : 1.0) * precision * std::max(1.0, diagonals / kLargeBall);
}

/** \brief A rounded number as 0, -1, 1, -2, 2 ... count from 0 on. */
inline std::uint32_t
zigzag(double steps)
{
  const auto v = static_cast<std::int32_t>(std::lround(std::clamp(steps, -kMostSteps, kMostSteps)));
  return v < 0 ? static_cast<std::uint32_t>(-2 * v - 1) : static_cast<std::uint32_t>(2 * v);
}

inline double
unzigzag(std::uint32_t code)
{
  return code % 2 == 0 ? 0.5 * code : -0.5 * (code + 1.0);
}

}  // namespace pcl_slim::detail

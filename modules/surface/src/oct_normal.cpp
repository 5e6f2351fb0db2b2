// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/oct_normal.h"

#include <cmath>

namespace pcl_slim {

namespace {

double
signOf(double value)
{
  return value < 0.0 ? -1.0 : 1.0;
}

}  // namespace

OctNormal
encodeNormal(const std::array<double, 3>& normal, double grid)
{
  const double sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
  if (!(sum > 0.0) || !std::isfinite(sum)) return {};
  double x = std::nearbyint(normal[0] / sum * grid);
  double y = std::nearbyint(normal[1] / sum * grid);
  // Keep |z| at one step or more.
  const double excess = std::abs(x) + std::abs(y) - (grid - 1.0);
  if (excess > 0.0) {
    double& larger = std::abs(x) >= std::abs(y) ? x : y;
    larger -= signOf(larger) * excess;
  }
  double a = x, b = y;
  if (std::signbit(normal[2])) {
    a = (grid - std::abs(y)) * signOf(x);
    b = (grid - std::abs(x)) * signOf(y);
  }
  return {static_cast<float>(a / grid), static_cast<float>(b / grid)};
}

std::array<float, 3>
decodeNormal(OctNormal code)
{
  double x = code.a, y = code.b;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0.0) {
    x = (1.0 - std::abs(static_cast<double>(code.b))) * signOf(code.a);
    y = (1.0 - std::abs(static_cast<double>(code.a))) * signOf(code.b);
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / length), static_cast<float>(y / length),
          static_cast<float>(z / length)};
}

std::array<float, 3>
snapNormal(const std::array<double, 3>& normal)
{
  return decodeNormal(encodeNormal(normal));
}

}  // namespace pcl_slim

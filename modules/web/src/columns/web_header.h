// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "columns/byte_planes.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Positive numbers as logarithms between the smallest and the largest; 0 stays 0. */
struct LogScale {
  int bytes = 1;                  ///< of a code
  double steps = 254.0;           ///< between the codes 1 and the largest
  double low = 1.0, ratio = 1.0;  ///< of code 1; largest over smallest

  /** \brief Widens the scale: a number that it codes. */
  void cover(const std::vector<float>& values)
  {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const float v : values) {
      if (v > 0.0f) {
        least = std::min(least, static_cast<double>(v));
        most = std::max(most, static_cast<double>(v));
      }
    }
    if (most > 0.0) {
      low = least;
      ratio = most / least;
    }
  }

  std::uint32_t code(double value) const
  {
    if (!(value > 0.0)) return 0;
    const double share = ratio > 1.0 ? std::log(value / low) / std::log(ratio) : 0.0;
    return 1 + static_cast<std::uint32_t>(std::lround(steps * std::clamp(share, 0.0, 1.0)));
  }

  double value(std::uint32_t code) const
  {
    return code == 0 ? 0.0 : low * std::pow(ratio, (code - 1.0) / steps);
  }
};

/** \brief The numbers before the columns. */
struct WebHeader {
  std::uint32_t surfels = 0, leaves = 0;
  SurfaceInfo info;
  bool colored = false;
  double precision = 0.0;                          ///< steps of a coefficient per radius; 0: floats
  double corner[3] = {0.0, 0.0, 0.0}, step = 1.0;  ///< of the grid of centres
  LogScale radius, size;
  LogScale error{2, 4094.0, 1.0, 1.0};  ///< weights follow from it

  void write(PlaneWriter& out) const;
  /** \return false for bytes that are no header of this version */
  bool read(PlaneReader& in);
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// How a page packs numbers: steps and logarithms in few bytes each, column by column, deflated.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/web/page.h"

namespace pcl_slim::detail {

constexpr std::uint32_t kWebMagic = 0x32504c53;  ///< "SLP2": a surface
constexpr double kCenterSteps = 65535.0;         ///< along the longest side of the centres' box
constexpr double kNormalGrid = 2047.0;           ///< steps of a coordinate to each side: 12 bits
constexpr std::uint32_t kEscape = 255;           ///< marks a coefficient with a three-byte code
constexpr double kMostSteps =
    8388607.0;  ///< largest number of steps that a three-byte code can represent

/** \brief Appends columns of numbers as byte planes: the lowest byte of every number, then the
 * next, which compresses better than number after number. Little-endian on every machine. */
class PlaneWriter {
 public:
  void put(const std::vector<std::uint32_t>& column, int bytes) {
    for (int plane = 0; plane < bytes; ++plane) {
      for (const std::uint32_t v : column) {
        data.push_back(static_cast<unsigned char>(v >> (8 * plane)));
      }
    }
  }

  void putNumber(std::uint32_t value) { put({value}, 4); }

  void putDouble(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    putNumber(static_cast<std::uint32_t>(bits));
    putNumber(static_cast<std::uint32_t>(bits >> 32));
  }

  std::vector<unsigned char> data;
};

/** \brief Positive numbers as logarithms between the smallest and the largest; 0 stays 0. */
struct LogScale {
  int bytes = 1;                  ///< of a code
  double steps = 254.0;           ///< between the codes 1 and the largest
  double low = 1.0, ratio = 1.0;  ///< of code 1; largest over smallest

  /** \brief Widens the scale: a number that it codes. */
  void cover(const std::vector<float>& values) {
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

  std::uint32_t code(double value) const {
    if (!(value > 0.0)) return 0;
    const double share = ratio > 1.0 ? std::log(value / low) / std::log(ratio) : 0.0;
    return 1 + static_cast<std::uint32_t>(std::lround(steps * std::clamp(share, 0.0, 1.0)));
  }

  double value(std::uint32_t code) const {
    return code == 0 ? 0.0 : low * std::pow(ratio, (code - 1.0) / steps);
  }
};

inline std::uint32_t bitsOf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/** \brief A coordinate of a normal's octahedral code as a number from 0 on. */
inline std::uint32_t gridCode(float coordinate) {
  return static_cast<std::uint32_t>(std::lround((coordinate + 1.0) * kNormalGrid));
}

/** \brief Steps per radius of coefficient k. The constant one moves the surface as a whole; steps
 * of large balls are as long as those of balls of kLargeBall diagonals. */
inline double stepsOf(double precision, std::size_t k, double diagonals) {
  constexpr double kLargeBall = 0.02;
  return (k == 0 ? 4.0 : 1.0) * precision * std::max(1.0, diagonals / kLargeBall);
}

/** \brief A rounded number as 0, -1, 1, -2, 2 ... count from 0 on. */
inline std::uint32_t zigzag(double steps) {
  const auto v = static_cast<std::int32_t>(std::lround(std::clamp(steps, -kMostSteps, kMostSteps)));
  return v < 0 ? static_cast<std::uint32_t>(-2 * v - 1) : static_cast<std::uint32_t>(2 * v);
}

/** \brief Places on a grid of 16 bits an axis over their box. */
class CenterCells {
 public:
  using Axes = std::array<const std::vector<float>*, 3>;

  explicit CenterCells(const Axes& axes) : axes_(axes) {
    double extent = 0.0;
    for (std::size_t k = 0; k < 3 && !axes[k]->empty(); ++k) {
      const auto [least, most] = std::minmax_element(axes[k]->begin(), axes[k]->end());
      corner[k] = static_cast<double>(*least);
      extent = std::max(extent, static_cast<double>(*most) - corner[k]);
    }
    if (extent > 0.0) step = extent / kCenterSteps;
  }

  std::uint32_t cell(std::size_t k, std::size_t i) const {
    return static_cast<std::uint32_t>(std::lround(((*axes_[k])[i] - corner[k]) / step));
  }

  /** \brief The place of the cell in the grid, in local units. */
  double rounded(std::size_t k, std::size_t i) const { return corner[k] + cell(k, i) * step; }

  /** \brief All places along a Morton curve, those of the first kind before the others.
   * \param[in] isFirst bool(std::uint32_t) */
  template <typename IsFirst>
  std::vector<std::uint32_t> order(const IsFirst& isFirst) const {
    std::vector<std::uint32_t> order;
    std::vector<std::uint64_t> keys;
    for (std::uint32_t i = 0; i < axes_[0]->size(); ++i) {
      order.push_back(i);
      keys.push_back(spreadBits(cell(0, i)) << 2 | spreadBits(cell(1, i)) << 1 |
                     spreadBits(cell(2, i)));
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (isFirst(a) != isFirst(b)) return isFirst(a);
      return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
    });
    return order;
  }

  /** \brief Writes steps from place to place. */
  void write(const std::vector<std::uint32_t>& order, PlaneWriter& out) const {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t last = 0;
      std::vector<std::uint32_t> steps;
      for (const std::uint32_t i : order) {
        steps.push_back((cell(k, i) - last) & 0xffffu);
        last = cell(k, i);
      }
      out.put(steps, 2);
    }
  }

  double corner[3] = {0.0, 0.0, 0.0}, step = 1.0;

 private:
  Axes axes_;
};

/** \brief The numbers before the columns. */
struct WebHeader {
  std::uint32_t surfels = 0, leaves = 0;
  SurfaceInfo info;
  bool colored = false, textured = false;
  double precision = 0.0;                          ///< steps of a coefficient per radius; 0: floats
  double corner[3] = {0.0, 0.0, 0.0}, step = 1.0;  ///< of the grid of centres
  LogScale radius, size;
  LogScale error{2, 4094.0, 1.0, 1.0};  ///< weights follow from it

  /** \brief Balls with textures have radii of 12 bits: 8 would move texels. */
  void setColors(bool has_colors, bool has_textures) {
    colored = has_colors;
    textured = has_textures;
    if (textured) radius = {2, 4094.0, radius.low, radius.ratio};
  }
  /** \brief 0: no colours, 1: polynomials, 2: textures as well. */
  std::uint32_t codeOfColors() const { return textured ? 2 : colored ? 1 : 0; }

  /** \brief Calls visit(double&) for the columns' numbers in their order. */
  template <typename Visit>
  void visitNumbers(const Visit& visit) {
    for (auto& axis : info.origin) visit(axis);
    for (auto* number : {&info.scale, &info.diagonal, &info.lambda, &info.cover_radius,
                         &info.cover_threshold, &precision}) {
      visit(*number);
    }
    for (auto& axis : corner) visit(axis);
    for (auto* number :
         {&step, &radius.low, &radius.ratio, &error.low, &error.ratio, &size.low, &size.ratio}) {
      visit(*number);
    }
  }
};

/** \brief Deflates bytes into a gzip stream with its checksum. \param[in] residuals number of the last
 * bytes that are what prediction left, in which longer matches are rare and costly to find */
Result<std::vector<unsigned char>> gzip(const std::vector<unsigned char>& bytes,
                                        std::size_t residuals = 0);

/** \brief Lines on a grid of 16 bits an axis, deflated. \param[in] origin, scale of the model, in
 * whose local units the viewer works */
Result<std::vector<unsigned char>> packLines(const std::vector<SpaceLine>& lines,
                                             const std::array<double, 3>& origin, double scale);

/** \brief Coloured discs, deflated: 16 bits a coordinate, normals of 12 bits a coordinate, radii as
 * 8-bit logarithms, colours as they are and their change over the disc in steps of 4. */
Result<std::vector<unsigned char>> packSplats(const SplatSet& splats);

}  // namespace pcl_slim::detail

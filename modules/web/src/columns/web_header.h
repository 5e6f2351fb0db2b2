// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Appends columns of numbers as byte planes: the lowest byte of every number, then the next, which
 * compresses better than number after number. Little-endian on every machine. */
class PlaneWriter {
 public:
  void put(const std::vector<std::uint32_t>& column, int bytes)
  {
    for (int plane = 0; plane < bytes; ++plane) {
      for (const std::uint32_t v : column) {
        data.push_back(static_cast<unsigned char>(v >> (8 * plane)));
      }
    }
  }

  void putNumber(std::uint32_t value) { put({value}, 4); }

  void putDouble(double value)
  {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    putNumber(static_cast<std::uint32_t>(bits));
    putNumber(static_cast<std::uint32_t>(bits >> 32));
  }

  std::vector<unsigned char> data;
};

/** \brief Reads what PlaneWriter wrote; zeros, and failed(), beyond its end. */
class PlaneReader {
 public:
  explicit PlaneReader(const std::vector<unsigned char>& data) : data_(data) {}

  std::vector<std::uint32_t> get(std::size_t count, int bytes)
  {
    failed_ = failed_ || count > left() / static_cast<std::size_t>(bytes);
    if (failed_) return {};
    std::vector<std::uint32_t> column(count, 0);
    for (int plane = 0; plane < bytes; ++plane) {
      for (std::uint32_t& v : column) v |= static_cast<std::uint32_t>(data_[at_++]) << (8 * plane);
    }
    return column;
  }

  std::uint32_t getNumber()
  {
    const auto one = get(1, 4);
    return failed_ ? 0 : one[0];
  }

  double getDouble()
  {
    const std::uint64_t low = getNumber(), bits = low | static_cast<std::uint64_t>(getNumber())
                                                            << 32;
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

  bool failed() const { return failed_; }
  std::size_t left() const { return data_.size() - at_; }

 private:
  const std::vector<unsigned char>& data_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

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

}  // namespace pcl_slim::detail

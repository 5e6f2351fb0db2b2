// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pcl_slim {

/** \brief Types of numbers in files, by the values of PCL's PCLPointField, whose 64-bit integers
 * have no name there before 1.13. */
enum ScalarType : std::uint8_t {
  kInt8 = 1,
  kUInt8 = 2,
  kInt16 = 3,
  kUInt16 = 4,
  kInt32 = 5,
  kUInt32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
  kInt64 = 9,
  kUInt64 = 10,
  kBool = 11
};

/** \brief Bytes of one value, 0 for an unknown type. */
constexpr std::size_t scalarSize(std::uint8_t type) {
  constexpr std::size_t kBytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 8, 8, 1};
  return type <= kBool ? kBytes[type] : 0;
}

/** \brief Value at an address of any alignment, in this machine's byte order; not a number for an
 * unknown type. */
inline double readScalar(const std::uint8_t* at, std::uint8_t type) {
  const auto as = [at](auto value) {
    std::memcpy(&value, at, sizeof(value));
    return static_cast<double>(value);
  };
  switch (type) {
    case kInt8: return as(std::int8_t{});
    case kUInt8:
    case kBool: return as(std::uint8_t{});
    case kInt16: return as(std::int16_t{});
    case kUInt16: return as(std::uint16_t{});
    case kInt32: return as(std::int32_t{});
    case kUInt32: return as(std::uint32_t{});
    case kFloat32: return as(float{});
    case kFloat64: return as(double{});
    case kInt64: return as(std::int64_t{});
    case kUInt64: return as(std::uint64_t{});
    default: return std::numeric_limits<double>::quiet_NaN();
  }
}

/** \brief The nearest float that is finite, of a number that is: one beyond the range of float does
 * not become infinite. */
inline float finiteFloat(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  if (value > kMost && value <= std::numeric_limits<double>::max())
    return std::numeric_limits<float>::max();
  if (value < -kMost && value >= std::numeric_limits<double>::lowest())
    return std::numeric_limits<float>::lowest();
  return static_cast<float>(value);
}

}  // namespace pcl_slim

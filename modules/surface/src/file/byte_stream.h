// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcl_slim::detail {

/** \brief Appends numbers to a list of bytes, little-endian on every machine. */
class ByteWriter {
 public:
  template <typename Unsigned>
  void putUnsigned(Unsigned value)
  {
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
    }
  }

  void putFloat(float value) { putBitsOf<std::uint32_t>(value); }
  void putDouble(double value) { putBitsOf<std::uint64_t>(value); }

  void putFloats(const std::vector<float>& column)
  {
    for (const float value : column) putFloat(value);
  }

  void putBytes(const std::vector<std::uint8_t>& column)
  {
    bytes.insert(bytes.end(), column.begin(), column.end());
  }

  std::vector<unsigned char> bytes;

 private:
  template <typename Bits, typename Value>
  void putBitsOf(Value value)
  {
    static_assert(sizeof(Bits) == sizeof(Value));
    Bits bits;
    std::memcpy(&bits, &value, sizeof(bits));
    putUnsigned(bits);
  }
};

/** \brief Reads what ByteWriter wrote; the caller has checked that enough bytes are there. */
class ByteReader {
 public:
  explicit ByteReader(const unsigned char* bytes) : at_(bytes) {}

  template <typename Unsigned>
  Unsigned getUnsigned()
  {
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      value = static_cast<Unsigned>(value | static_cast<Unsigned>(*at_++) << (8 * i));
    }
    return value;
  }

  float getFloat() { return getBitsAs<float, std::uint32_t>(); }
  double getDouble() { return getBitsAs<double, std::uint64_t>(); }

  void getFloats(std::vector<float>& column)
  {
    for (float& value : column) value = getFloat();
  }

  void getBytes(std::vector<std::uint8_t>& column)
  {
    for (std::uint8_t& value : column) value = *at_++;
  }

 private:
  template <typename Value, typename Bits>
  Value getBitsAs()
  {
    static_assert(sizeof(Bits) == sizeof(Value));
    const auto bits = getUnsigned<Bits>();
    Value value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  const unsigned char* at_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace pcl_slim_test {

/** A LAS file made by hand: header, one VLR of text, one of extra bytes, records, and a tail. */
struct LasBytes {
  std::vector<unsigned char> bytes;
  std::size_t points_at = 0, record_bytes = 0, count = 0;

  template <typename T>
  void put(std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(value));
  }
  template <typename T>
  T get(std::size_t at) const {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(value));
    return value;
  }
  unsigned char* record(std::size_t i) { return bytes.data() + points_at + i * record_bytes; }
};

/** Bytes of the records of LAS 1.4's point formats, from the specification's tables. */
constexpr std::size_t kLasSizes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/** The VLR of a float and of three bytes. */
inline void describeExtra(std::size_t vlr, LasBytes& las) {
  std::memcpy(las.bytes.data() + vlr + 2, "LASF_Spec", 9);
  las.put(vlr + 18, std::uint16_t{4});
  las.put(vlr + 20, std::uint16_t{2 * 192});
  las.bytes[vlr + 54 + 2] = 9;  // float
  std::memcpy(las.bytes.data() + vlr + 54 + 4, "depth", 5);
  las.bytes[vlr + 54 + 192 + 2] = 21;  // three bytes
  std::memcpy(las.bytes.data() + vlr + 54 + 192 + 4, "my triple", 9);
}

/** A file of count points with random bits in every value. \param[in] extra whether a point has a
 * float "depth", a triple of bytes and two bytes that nothing describes. */
inline LasBytes lasBytes(int format, std::size_t count, bool extra, unsigned int seed = 1) {
  const int minor = format < 4 ? 2 : format < 6 ? 3 : 4;
  const std::size_t header = minor == 2 ? 227 : minor == 3 ? 235 : 375;
  LasBytes las;
  las.count = count;
  las.record_bytes = kLasSizes[format] + (extra ? 9 : 0);
  las.points_at = header + 54 + 7 + (extra ? 54 + 2 * 192 : 0) + 2;
  const std::string tail = minor == 4 ? "an extended record" : "";
  const std::size_t end = las.points_at + count * las.record_bytes;
  las.bytes.assign(end, 0);
  std::memcpy(las.bytes.data(), "LASF", 4);
  las.bytes[24] = 1;
  las.bytes[25] = static_cast<unsigned char>(minor);
  las.put(94, static_cast<std::uint16_t>(header));
  las.put(96, static_cast<std::uint32_t>(las.points_at));
  las.put(100, std::uint32_t{extra ? 2u : 1u});
  las.bytes[104] = static_cast<unsigned char>(format);
  las.put(105, static_cast<std::uint16_t>(las.record_bytes));
  las.put(107, static_cast<std::uint32_t>(format < 6 ? count : 0));
  if (minor == 4) {
    las.put(235, std::uint64_t{end});
    las.put(243, std::uint32_t{1});
    las.put(247, std::uint64_t{count});
  }
  std::memcpy(las.bytes.data() + header + 2, "somebody", 8);
  las.put(header + 20, std::uint16_t{7});
  std::memcpy(las.bytes.data() + header + 54, "a text.", 7);
  if (extra) describeExtra(header + 61, las);
  std::mt19937 random(seed);
  const double scale[3] = {0.01, 0.001, 0.25}, offset[3] = {500000, 4918360.25, -7};
  std::int32_t low[3], high[3];
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < las.record_bytes; ++k)
      las.record(i)[k] = static_cast<unsigned char>(random());
    for (std::size_t a = 0; a < 3; ++a) {
      const auto code = static_cast<std::int32_t>(random() % 2000000) - 1000000;
      std::memcpy(las.record(i) + 4 * a, &code, 4);
      low[a] = i == 0 ? code : std::min(low[a], code);
      high[a] = i == 0 ? code : std::max(high[a], code);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    las.put(131 + 8 * a, scale[a]);
    las.put(155 + 8 * a, offset[a]);
    if (count == 0) continue;
    las.put(179 + 16 * a, high[a] * scale[a] + offset[a]);
    las.put(187 + 16 * a, low[a] * scale[a] + offset[a]);
  }
  las.bytes.insert(las.bytes.end(), tail.begin(), tail.end());
  return las;
}

}  // namespace pcl_slim_test

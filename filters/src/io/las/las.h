// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

constexpr int kMostLasFormat = 10;

/** One value of a point record behind X, Y and Z (ASPRS, LAS 1.4 R15, tables 7 to 17). */
struct LasItem {
  std::string name;
  std::uint8_t type = 0;    ///< ScalarType
  std::size_t offset = 0;   ///< bytes from the record's begin
  int shift = 0, bits = 0;  ///< of a byte that several values share; bits 0: the value has it alone
};

/** The values of a point data record format, 0 to 10, in the record's order. */
std::vector<LasItem> lasItems(int format);

/** Bytes of a record of this format without extra bytes. */
std::size_t lasRecordBytes(int format);

/** A little-endian value at any address; this machine's order is the same. */
template <typename T>
T getLas(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof(value));
  return value;
}

template <typename T>
void putLas(std::vector<unsigned char>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

/** Where the parts of a LAS file's public header block begin (ASPRS, LAS 1.4 R15, table 3). */
struct LasAt {
  static constexpr std::size_t kGlobalEncoding = 6, kVersion = 24, kSystem = 26, kSoftware = 58;
  static constexpr std::size_t kHeaderBytes = 94, kPointsAt = 96, kNumVlrs = 100, kFormat = 104;
  static constexpr std::size_t kRecordBytes = 105, kOldCount = 107, kOldReturns = 111;
  static constexpr std::size_t kScale = 131, kOffset = 155, kBox = 179, kWaveform = 227;
  static constexpr std::size_t kEvlrs = 235, kNumEvlrs = 243, kCount = 247, kReturns = 255;
};
constexpr std::size_t kOldLasHeaderBytes = 227, kLasHeaderBytes = 375;

/** An extra value of a point record, behind those of its format, as its VLR describes it. */
struct LasExtra {
  std::string name;
  std::uint8_t type = 0;  ///< ScalarType
  std::size_t count = 1;
  std::vector<unsigned char> record;  ///< its 192 bytes in the VLR; empty: none describes it

  std::size_t bytes() const;
};

/** What is needed to read and write the points. */
struct LasHeader {
  int minor = 4;   ///< of version 1.minor
  int format = 0;  ///< of the point data records
  std::size_t header_bytes = 0, points_at = 0, record_bytes = 0;
  std::uint64_t points = 0;
  std::array<double, 3> scale{}, offset{};
  std::vector<LasExtra> extras;  ///< they fill the records' rest
};

/** Reads the header and the VLRs. \param[in] bytes those before the points, at least; \param[in]
 * size of the whole file, in bytes. */
Result<LasHeader> parseLasHeader(const std::vector<unsigned char>& bytes, std::uint64_t size);

/** Whether the coordinate system of a file is geographic: x and y are degrees. \param[in] head the bytes
 * before the points; \param[in] tail those behind them, from byte tail_at of the file on. */
bool hasDegrees(const std::vector<unsigned char>& head, const std::vector<unsigned char>& tail,
                std::uint64_t tail_at);

/** The header of a new file, version 1.4, of a point format from 6 on; counts, box and record
 * length are put in when it is written. */
std::vector<unsigned char> newLasHead(int format);

/** A head with the VLR of extra bytes replaced, or taken away where there are no extras. */
Result<std::vector<unsigned char>> withExtras(const std::vector<unsigned char>& head,
                                              const std::vector<LasExtra>& extras);

}  // namespace pcl_slim

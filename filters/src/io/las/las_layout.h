// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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
std::vector<LasItem>
lasItems(int format);

/** Bytes of a record of this format without extra bytes. */
std::size_t
lasRecordBytes(int format);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "io/pcd/lzf.h"

#include <cstring>

namespace pcl_slim::detail {

bool
decodeLzf(const std::uint8_t* packed, std::size_t packed_size, std::uint8_t* plain,
          std::size_t size)
{
  constexpr unsigned int kMostLiterals = 32, kLongMatch = 7;
  std::size_t in = 0, out = 0;
  while (in < packed_size) {
    const unsigned int control = packed[in++];
    if (control < kMostLiterals) {
      const std::size_t count = control + 1;
      if (count > packed_size - in || count > size - out) return false;
      std::memcpy(plain + out, packed + in, count);
      in += count;
      out += count;
      continue;
    }
    // A match: three bits of length, thirteen of distance; long ones have a byte more.
    std::size_t count = control >> 5;
    if (count == kLongMatch && in < packed_size) count += packed[in++];
    if (in == packed_size) return false;
    const std::size_t distance = (std::size_t{control & 31u} << 8 | packed[in++]) + 1;
    count += 2;
    if (distance > out || count > size - out) return false;
    for (const std::size_t end = out + count; out < end; ++out) plain[out] = plain[out - distance];
  }
  return out == size;
}

}  // namespace pcl_slim::detail

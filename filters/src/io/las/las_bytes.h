// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <vector>

namespace pcl_slim {

/** A little-endian value at any address; this machine's order is the same. */
template <typename T>
T
getLas(const unsigned char* at)
{
  T value;
  std::memcpy(&value, at, sizeof(value));
  return value;
}

template <typename T>
void
putLas(std::vector<unsigned char>& bytes, std::size_t at, T value)
{
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}

}  // namespace pcl_slim

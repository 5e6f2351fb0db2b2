// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/cloud/morton.h"

namespace pcl_slim {

/** Morton code of a position given in root cells, halved depth times; up to 21 bits an axis. */
inline std::uint64_t
mortonKey(const float position[3], int depth)
{
  const auto scale = static_cast<float>(1 << depth);
  const auto cell = [&](int a) {
    return spreadBits(static_cast<std::uint64_t>(static_cast<std::int32_t>(position[a] * scale)));
  };
  return cell(0) << 2 | cell(1) << 1 | cell(2);
}

/** The same for many positions on a grid of few bits: by a table, where they are 10 or fewer. */
class MortonKeys {
 public:
  /** bits: of an axis, roots and halvings together. */
  MortonKeys(int bits, int depth)
      : bits_(bits), depth_(depth), scale_(static_cast<float>(1 << depth))
  {
    if (bits > kTableBits) return;
    for (std::uint32_t i = 0; i < table_.size(); ++i) {
      table_[i] = static_cast<std::uint32_t>(spreadBits(i));
    }
  }

  std::uint64_t operator()(const float position[3]) const
  {
    if (bits_ > kTableBits) return mortonKey(position, depth_);
    const auto cell = [&](int a) {
      return table_[static_cast<std::size_t>(static_cast<std::int32_t>(position[a] * scale_))];
    };
    return cell(0) << 2 | cell(1) << 1 | cell(2);
  }

 private:
  static constexpr int kTableBits = 10;

  int bits_, depth_;
  float scale_;
  std::array<std::uint32_t, std::size_t{1} << kTableBits> table_;
};

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/cloud/morton.h"

namespace pcl_slim::detail {

/** Morton code of a position given in root cells, halved depth times; up to 21 bits an axis. */
inline std::uint64_t
mortonKey(const std::array<float, 3>& position, int depth)
{
  const auto scale = static_cast<float>(1 << depth);
  const auto cell = [&](std::size_t a) {
    return spreadBits(static_cast<std::uint64_t>(static_cast<std::int32_t>(position[a] * scale)));
  };
  return cell(0) << 2 | cell(1) << 1 | cell(2);
}

}  // namespace pcl_slim::detail

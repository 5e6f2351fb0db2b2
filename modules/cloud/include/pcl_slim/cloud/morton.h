// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace pcl_slim {

constexpr int kMortonBits = 21;  ///< bits per axis, 63 in all

/** \brief Spreads the low 21 bits of v so that two zero bits follow each. */
inline std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}

/** \brief Every third bit of v: the inverse of spreadBits(). */
inline std::uint32_t gatherBits(std::uint64_t v) {
  v &= 0x1249249249249249ULL;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ULL;
  v = (v | v >> 4) & 0x100f00f00f00f00fULL;
  v = (v | v >> 8) & 0x1f0000ff0000ffULL;
  v = (v | v >> 16) & 0x1f00000000ffffULL;
  return static_cast<std::uint32_t>((v | v >> 32) & 0x1fffff);
}

/** \brief Cell number along one axis of a local coordinate in [-1/2, 1/2]. */
inline std::uint64_t mortonCell(double local) {
  const double cells = static_cast<double>(1 << kMortonBits);
  const double cell = (local + 0.5) * cells;
  if (!(cell > 0.0)) return 0;
  return cell >= cells ? (1u << kMortonBits) - 1 : static_cast<std::uint64_t>(cell);
}

/** \brief The 63-bit Morton code of a local position, three bits a level, x highest. */
inline std::uint64_t mortonCode(double x, double y, double z) {
  return spreadBits(mortonCell(x)) << 2 | spreadBits(mortonCell(y)) << 1 |
         spreadBits(mortonCell(z));
}

}  // namespace pcl_slim

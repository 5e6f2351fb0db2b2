// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace pcl_slim {

/** \brief Turns a number into one whose bits all depend on all of its bits: the last step of
 * SplitMix64 (Steele, Lea, Flood 2014). */
inline std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/** \brief The numbers of SplitMix64: each depends on the start and its place in the sequence alone.
 */
struct SplitMix {
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;

  std::uint64_t state;

  std::uint64_t next() { return mixBits(state += kStep); }
  /** \brief The next one as a number in [0, 1). */
  double nextShare() { return static_cast<double>(next() >> 11) * 0x1p-53; }
};

/** \brief A hash of a finite place; equal ones have equal hashes. */
inline std::uint64_t placeHash(const std::array<double, 3>& p) {
  std::uint64_t hash = 0x2545f4914f6cdd1du;
  for (const double coordinate : p) {
    const double value = coordinate + 0.0;  // -0 is 0
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * SplitMix::kStep;
    hash ^= hash >> 29;
  }
  hash *= 0xbf58476d1ce4e5b9u;
  return hash ^ hash >> 32;
}

}  // namespace pcl_slim

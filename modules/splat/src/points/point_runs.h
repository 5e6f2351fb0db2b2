// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace pcl_slim::detail {

/** Points of one root that follow each other in the caller's order. */
struct PointRun {
  std::uint64_t root;
  std::uint32_t first, count;

  /** Lists them from place on, where more may be written up to last. \return where they end. */
  std::uint32_t* list(std::uint32_t* place, const std::uint32_t* last) const
  {
    constexpr std::uint32_t kStep = 8;  // most runs are no longer, and how long is not foreseen
    std::uint32_t* const end = place + count;
    std::uint32_t index = first;
    for (; place < end && last - place >= kStep; place += kStep) {
      for (std::uint32_t k = 0; k < kStep; ++k) place[k] = index++;
    }
    for (; place < end; ++place) *place = index++;
    return end;
  }
};

/** A run in one number: the key of a cell, then the index of a point in it, then how many points
 * behind that one follow it in the caller's order and lie in the same cell. */
struct RunFormat {
  static constexpr int kCountBits = 8;  ///< of as many points as are looked at together

  int index_bits = 0;
  int count_bits = 0;  ///< kCountBits, or 0: every point is a run of its own

  int keyBit() const { return index_bits + count_bits; }
  std::uint32_t first(std::uint64_t run) const
  {
    return static_cast<std::uint32_t>(run >> count_bits & ((std::uint64_t{1} << index_bits) - 1));
  }
  std::uint32_t count(std::uint64_t run) const
  {
    return static_cast<std::uint32_t>(run & ((std::uint64_t{1} << count_bits) - 1)) + 1;
  }

  /** Joins runs of one point each, at most 2^kCountBits and at least one. \return how many are left;
   * out has room for all. */
  std::size_t join(const std::uint64_t* points, std::size_t n, std::uint64_t* out) const
  {
    if (count_bits == 0) {
      std::copy_n(points, n, out);
      return n;
    }
    std::uint32_t begins[(1 << kCountBits) + 1];
    const std::uint64_t next = std::uint64_t{1} << count_bits;  // the same key, one index on
    std::size_t runs = 0;
    std::uint64_t expected = ~points[0];
    for (std::size_t i = 0; i < n; ++i) {
      out[runs] = points[i];
      begins[runs] = static_cast<std::uint32_t>(i);
      runs += points[i] != expected;
      expected = points[i] + next;
    }
    begins[runs] = static_cast<std::uint32_t>(n);
    for (std::size_t r = 0; r < runs; ++r) out[r] |= begins[r + 1] - begins[r] - 1;
    return runs;
  }
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief A square of bits, row by row, each row in whole words: many columns at once. */
class BitRows {
 public:
  /** \brief Sets the size; every bit is 0 then. */
  void reset(int side)
  {
    side_ = side;
    words_ = static_cast<std::size_t>(side + 63) / 64;
    bits_.assign(words_ * static_cast<std::size_t>(side), 0);
  }

  int side() const { return side_; }
  std::size_t wordsPerRow() const { return words_; }
  std::uint64_t* row(int y) { return bits_.data() + static_cast<std::size_t>(y) * words_; }
  const std::uint64_t* row(int y) const
  {
    return bits_.data() + static_cast<std::size_t>(y) * words_;
  }

  void set(int x, int y) { row(y)[x >> 6] |= std::uint64_t{1} << (x & 63); }

  /** \brief Sets columns first to last, both among the row's. */
  void setRun(int y, int first, int last)
  {
    std::uint64_t* words = row(y);
    for (int w = first >> 6; w <= last >> 6; ++w) {
      const int low = first > 64 * w ? first - 64 * w : 0;
      const int high = last < 64 * w + 63 ? last - 64 * w : 63;
      words[w] |= (std::uint64_t{2} << high) - (std::uint64_t{1} << low);
    }
  }

 private:
  int side_ = 0;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace pcl_slim::detail

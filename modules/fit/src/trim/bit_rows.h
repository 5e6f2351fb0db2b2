// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_slim::detail {

/** \brief A square of bits, row by row, each row in whole words: one operation handles many columns. */
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
  std::size_t numWords() const { return bits_.size(); }
  std::uint64_t* row(int y) { return bits_.data() + static_cast<std::size_t>(y) * words_; }
  const std::uint64_t* row(int y) const
  {
    return bits_.data() + static_cast<std::size_t>(y) * words_;
  }

  void set(int x, int y) { row(y)[x >> 6] |= std::uint64_t{1} << (x & 63); }

  bool has(int x, int y) const { return (row(y)[x >> 6] >> (x & 63) & 1) != 0; }

  /** \brief The bits of a row's last word that are columns. */
  std::uint64_t inLastWord() const { return (std::uint64_t{2} << ((side_ - 1) & 63)) - 1; }

  /** \brief Sets the bits that others of the same side have. */
  void add(const BitRows& other)
  {
    for (std::size_t w = 0; w < bits_.size(); ++w) bits_[w] |= other.bits_[w];
  }

  /** \brief Sets columns first to last, both among the row's. */
  void setRun(int y, int first, int last)
  {
    std::uint64_t* words = row(y);
    if (first >> 6 == last >> 6) {
      words[first >> 6] |= (std::uint64_t{2} << (last & 63)) - (std::uint64_t{1} << (first & 63));
      return;
    }
    for (int w = first >> 6; w <= last >> 6; ++w) {
      const int low = first > 64 * w ? first - 64 * w : 0;
      const int high = last < 64 * w + 63 ? last - 64 * w : 63;
      words[w] |= (std::uint64_t{2} << high) - (std::uint64_t{1} << low);
    }
  }

  /** \brief Sets all columns but those from first to last; all if last < first. */
  void setAllBut(int y, int first, int last)
  {
    if (last < first) {
      setRun(y, 0, side_ - 1);
      return;
    }
    if (first > 0) setRun(y, 0, first - 1);
    if (last < side_ - 1) setRun(y, last + 1, side_ - 1);
  }

 private:
  int side_ = 0;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/** \brief Keeps the set bits whose neighbours in the row are set too; those beyond the row are. */
inline void
erodeRow(const std::uint64_t* from, std::size_t words, std::uint64_t* to)
{
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t before = w > 0 ? from[w - 1] >> 63 : 1;
    const std::uint64_t after = w + 1 < words ? from[w + 1] << 63 : std::uint64_t{1} << 63;
    to[w] = from[w] & (from[w] << 1 | before) & (from[w] >> 1 | after);
  }
}

/** \brief Likewise in all rows. */
inline void
erodeRows(const BitRows& from, BitRows& to)
{
  to.reset(from.side());
  if (from.wordsPerRow() > 1) {
    for (int y = 0; y < from.side(); ++y) erodeRow(from.row(y), from.wordsPerRow(), to.row(y));
    return;
  }
  const std::uint64_t* rows = from.row(0);  // one word each: vectorised
  for (std::size_t y = 0; y < from.numWords(); ++y)
    to.row(0)[y] = rows[y] & (rows[y] << 1 | 1) & (rows[y] >> 1 | std::uint64_t{1} << 63);
}

/** \brief Sets the bits next to set ones. */
inline void
widenRow(std::uint64_t* row, std::size_t words)
{
  std::uint64_t before = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t old = row[w], after = w + 1 < words ? row[w + 1] << 63 : 0;
    row[w] = old | (old << 1 | before) | (old >> 1 | after);
    before = old >> 63;
  }
}

}  // namespace pcl_slim::detail

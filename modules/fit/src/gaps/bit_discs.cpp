// SPDX-License-Identifier: BSD-3-Clause
// Morphology on rows of bits: 64 cells at a time.
#include "gaps/bit_discs.h"

#include <cmath>

namespace pcl_slim::detail {

namespace {

/** Widens every run of set bits of a row by one cell at either end. */
void
widenRow(std::uint64_t* row, std::size_t words)
{
  std::uint64_t last = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t own = row[w], next = w + 1 < words ? row[w + 1] : 0;
    row[w] = own | own << 1 | own >> 1 | last >> 63 | next << 63;
    last = own;
  }
}

void
addRow(const std::uint64_t* from, std::size_t words, std::uint64_t* to)
{
  for (std::size_t w = 0; w < words; ++w) to[w] |= from[w];
}

std::uint64_t
bitsOfLastWord(int side)
{
  return (std::uint64_t{2} << ((side - 1) & 63)) - 1;
}

}  // namespace

void
uniteRows(const BitRows& one, const BitRows& other, BitRows& united)
{
  united = one;
  for (int y = 0; y < one.side(); ++y) addRow(other.row(y), one.wordsPerRow(), united.row(y));
}

void
spreadByDisc(const BitRows& rows, double reach, BitRows& scratch, BitRows& spread)
{
  const int side = rows.side();
  const std::size_t words = rows.wordsPerRow();
  scratch = rows;
  spread.reset(side);
  // From a disc's narrow rows to its wide ones.
  int width = 0;
  for (int up = static_cast<int>(reach); up >= 0; --up) {
    const int half = static_cast<int>(std::sqrt(reach * reach - up * up));
    for (; width < half; ++width) {
      for (int y = 0; y < side; ++y) widenRow(scratch.row(y), words);
    }
    for (int y = 0; y < side; ++y) {
      if (y >= up) addRow(scratch.row(y), words, spread.row(y - up));
      if (up > 0 && y + up < side) addRow(scratch.row(y), words, spread.row(y + up));
    }
  }
  for (int y = 0; y < side; ++y) spread.row(y)[words - 1] &= bitsOfLastWord(side);
}

bool
complement(BitRows& rows)
{
  const std::size_t words = rows.wordsPerRow();
  std::uint64_t any = 0;
  for (int y = 0; y < rows.side(); ++y) {
    std::uint64_t* row = rows.row(y);
    for (std::size_t w = 0; w < words; ++w) row[w] = ~row[w];
    row[words - 1] &= bitsOfLastWord(rows.side());
    for (std::size_t w = 0; w < words; ++w) any |= row[w];
  }
  return any != 0;
}

}  // namespace pcl_slim::detail

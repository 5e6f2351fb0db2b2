// SPDX-License-Identifier: BSD-3-Clause
#include "trim/gap_search.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kBlock = 5;       ///< cells a side of a block
constexpr int kMostHalf = 127;  ///< cells from the middle: finer ones tell no more

/** Bits that begin a run of kBlock zeros in a row; what lies beyond the row counts as ones. */
void
findEmptyRuns(const std::uint64_t* held, int side, std::uint64_t* runs)
{
  const int last = (side - 1) >> 6;
  const std::uint64_t in_last = (std::uint64_t{2} << ((side - 1) & 63)) - 1;
  const auto emptyOf = [&](int w) {
    return w < last ? ~held[w] : w == last ? ~held[w] & in_last : 0;
  };
  for (int w = 0; w <= last; ++w) {
    const std::uint64_t empty = emptyOf(w), next = emptyOf(w + 1);
    std::uint64_t run = empty;
    for (int k = 1; k < kBlock; ++k) run &= empty >> k | next << (64 - k);
    runs[w] = run;
  }
}

}  // namespace

bool
GapSearch::hasEmptyBlock()
{
  const std::size_t words = held_.wordsPerRow();
  empty_runs_.reset(held_.side());
  for (int y = 0; y < held_.side(); ++y)
    findEmptyRuns(held_.row(y), held_.side(), empty_runs_.row(y));
  for (int y = 0; y + kBlock <= held_.side(); ++y) {
    for (std::size_t w = 0; w < words; ++w) {
      std::uint64_t block = empty_runs_.row(y)[w];
      for (int k = 1; k < kBlock; ++k) block &= empty_runs_.row(y + k)[w];
      if (block != 0) return true;
    }
  }
  return false;
}

bool
GapSearch::mayHaveGap(const SheetPoints& points, const KnownRegion& known, double hole,
                      const TrimConstants& constants)
{
  const int half = std::min(
      kMostHalf, static_cast<int>(std::ceil(constants.known / (constants.gap_cell * hole))));
  const auto per_unit = static_cast<float>(half / constants.known);
  held_.reset(2 * half);
  for (std::size_t i = 0; i < points.count; ++i) {
    const int x = static_cast<int>(points.u[i] * per_unit + static_cast<float>(half));
    const int y = static_cast<int>(points.v[i] * per_unit + static_cast<float>(half));
    held_.set(std::clamp(x, 0, 2 * half - 1), std::clamp(y, 0, 2 * half - 1));
  }
  // Of cells beyond nothing is known: they are no gap.
  known.markBeyond(constants.known / half, half - 0.5, held_);
  return hasEmptyBlock();
}

}  // namespace pcl_slim::detail

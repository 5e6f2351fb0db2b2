// SPDX-License-Identifier: BSD-3-Clause
#include "trim/gap_search.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kLong = 6, kShort = 4;  ///< cells of the rows of a patch, and its height in cells
constexpr int kApart = 4;
constexpr int kMostHalf = 127;  ///< cells from the middle: finer ones tell no more

/** Bits that begin runs of kLong and of kShort zeros in a row; what lies beyond the row counts as ones. */
void
findEmptyRuns(const std::uint64_t* held, int side, std::uint64_t* long_runs,
              std::uint64_t* short_runs)
{
  const int last = (side - 1) >> 6;
  const std::uint64_t in_last = (std::uint64_t{2} << ((side - 1) & 63)) - 1;
  const auto emptyOf = [&](int w) {
    return w < last ? ~held[w] : w == last ? ~held[w] & in_last : 0;
  };
  for (int w = 0; w <= last; ++w) {
    const std::uint64_t empty = emptyOf(w), next = emptyOf(w + 1);
    const auto shifted = [&](int k) { return empty >> k | next << (64 - k); };
    std::uint64_t run = empty;
    for (int k = 1; k < kShort; ++k) run &= shifted(k);
    short_runs[w] = run;
    for (int k = kShort; k < kLong; ++k) run &= shifted(k);
    long_runs[w] = run;
  }
}

}  // namespace

/** Lists the middles of places where rows of 4, 6, 6, 6, 6 and 4 cells are empty, each in the middle of the
 * next: what a disc of eight cells' width leaves empty wherever it is. At most one of
 * kApart in a row. */
void
GapSearch::listEmptyPatches(double cell, std::vector<std::array<double, 2>>& places)
{
  const int side = held_.side();
  long_runs_.reset(side);
  short_runs_.reset(side);
  for (int y = 0; y < side; ++y) {
    findEmptyRuns(held_.row(y), side, long_runs_.row(y), short_runs_.row(y));
  }
  for (int y = 0; y + kLong <= side; ++y) {
    const std::uint64_t *first = short_runs_.row(y), *last = short_runs_.row(y + kLong - 1);
    for (std::size_t w = 0; w < held_.wordsPerRow(); ++w) {
      const bool more = w + 1 < held_.wordsPerRow();
      const std::uint64_t ends = first[w] & last[w], next = more ? first[w + 1] & last[w + 1] : 0;
      std::uint64_t patch = ends >> 1 | next << 63;
      for (int k = 1; k < kLong - 1; ++k) patch &= long_runs_.row(y + k)[w];
      if (patch == 0) continue;
      for (int bit = 0; bit < 64; ++bit) {
        if ((patch >> bit & 1) == 0) continue;
        const int x = static_cast<int>(64 * w) + bit;
        places.push_back({cell * (x + 0.5 * (kLong - side)), cell * (y + 0.5 * (kLong - side))});
        bit += kApart - 1;
      }
    }
  }
}

void
GapSearch::find(const SheetPoints& points, const KnownRegion& known, double hole,
                const TrimConstants& constants, std::vector<std::array<double, 2>>& places)
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
  places.clear();
  listEmptyPatches(constants.known / half, places);
}

}  // namespace pcl_slim::detail

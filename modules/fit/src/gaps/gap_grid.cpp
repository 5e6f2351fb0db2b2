// SPDX-License-Identifier: BSD-3-Clause
#include "gaps/gap_grid.h"

#include <algorithm>
#include <cmath>

#include "gaps/bit_discs.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

constexpr int kMostHalf = 127;  ///< cells from the middle: finer ones tell no more
constexpr double kFoldShares[] = {1.0, 0.85, 0.7,
                                  0.55};  ///< of a place's distance: where a fold would be

/** Squared length of the gradient of h. */
double
slopeSq(const SheetHeight& sheet, double u, double v)
{
  const float* c = sheet.c;
  double hu = c[1], hv = c[2];
  if (sheet.degree >= 2) {
    hu += 2.0 * c[3] * u + c[4] * v;
    hv += c[4] * u + 2.0 * c[5] * v;
  }
  if (sheet.degree >= 3) {
    hu += u * (3.0 * c[6] * u + 2.0 * c[7] * v) + c[8] * v * v;
    hv += c[7] * u * u + v * (2.0 * c[8] * u + 3.0 * c[9] * v);
  }
  if (sheet.degree >= 4) {
    hu += u * u * (4.0 * c[10] * u + 3.0 * c[11] * v) + v * v * (2.0 * c[12] * u + c[13] * v);
    hv += u * u * (c[11] * u + 2.0 * c[12] * v) + v * v * (3.0 * c[13] * u + 4.0 * c[14] * v);
  }
  return hu * hu + hv * hv;
}

int
lowestBit(std::uint64_t word)
{
  return __builtin_ctzll(word);
}

int
highestBit(std::uint64_t word)
{
  return 63 - __builtin_clzll(word);
}

}  // namespace

void
GapGrid::mark(const SheetPoints& points, const KnownRegion& known, double view, double cell)
{
  half_ = std::min(kMostHalf, static_cast<int>(std::ceil(view / cell)));
  cell_ = view / half_;
  const int side = 2 * half_;
  const auto per_unit = static_cast<float>(half_ / view);
  occupied_.reset(side);
  for (std::size_t i = 0; i < points.count; ++i) {
    const int x = static_cast<int>(points.u[i] * per_unit + static_cast<float>(half_));
    const int y = static_cast<int>(points.v[i] * per_unit + static_cast<float>(half_));
    occupied_.set(std::clamp(x, 0, side - 1), std::clamp(y, 0, side - 1));
  }
  beyond_.reset(side);
  known.markBeyond(cell_, half_ - 0.5, beyond_);
}

/** Whether the sheet is steep at a cell or somewhat nearer to the middle: noise carries points past a fold. */
bool
GapGrid::isSteep(const SheetHeight& sheet, int x, int y) const
{
  for (const double share : kFoldShares) {
    if (slopeSq(sheet, share * middle(x), share * middle(y)) > steepest_sq_) return true;
  }
  return false;
}

void
GapGrid::hideAlongRows(const SheetHeight& sheet)
{
  const int side = occupied_.side();
  const auto words = static_cast<int>(occupied_.wordsPerRow());
  for (int y = 0; y < side; ++y) {
    const std::uint64_t* row = occupied_.row(y);
    int first = 0, last = words - 1;
    while (first < words && row[first] == 0) ++first;
    if (first == words) continue;
    while (row[last] == 0) --last;
    const int left = 64 * first + lowestBit(row[first]);
    const int right = 64 * last + highestBit(row[last]);
    if (left > 0 && isSteep(sheet, left, y)) beyond_.setRun(y, 0, left - 1);
    if (right < side - 1 && isSteep(sheet, right, y)) beyond_.setRun(y, right + 1, side - 1);
  }
}

/** The same of all columns at once, from one end or from the other. */
void
GapGrid::hideAlongColumns(const SheetHeight& sheet, bool upwards)
{
  const int side = occupied_.side();
  const std::size_t words = occupied_.wordsPerRow();
  const auto rowAt = [&](int k) { return upwards ? k : side - 1 - k; };
  scratch_.reset(side);  // the outermost points of columns, where the sheet is steep
  columns_.assign(words, 0);
  for (int k = side - 1; k >= 0; --k) {
    const std::uint64_t* row = occupied_.row(rowAt(k));
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t fresh = row[w] & ~columns_[w]; fresh != 0; fresh &= fresh - 1) {
        const int x = static_cast<int>(64 * w) + lowestBit(fresh);
        if (isSteep(sheet, x, rowAt(k))) scratch_.set(x, rowAt(k));
      }
      columns_[w] |= row[w];
    }
  }
  columns_.assign(words, 0);
  for (int k = 0; k < side; ++k) {
    for (std::size_t w = 0; w < words; ++w) {
      beyond_.row(rowAt(k))[w] |= columns_[w];
      columns_[w] |= scratch_.row(rowAt(k))[w];
    }
  }
}

void
GapGrid::hideFolds(const SheetHeight& sheet, double steepest)
{
  steepest_sq_ = steepest * steepest;
  hideAlongRows(sheet);
  hideAlongColumns(sheet, true);
  hideAlongColumns(sheet, false);
}

bool
GapGrid::findCenters(double diameter)
{
  uniteRows(occupied_, beyond_, closed_);
  spreadByDisc(closed_, 0.5 * diameter / cell_, scratch_, centers_);
  return complement(centers_);
}

std::size_t
GapGrid::numCenters() const
{
  std::size_t count = 0;
  for (int y = 0; y < centers_.side(); ++y) {
    for (std::size_t w = 0; w < centers_.wordsPerRow(); ++w) {
      count += static_cast<std::size_t>(__builtin_popcountll(centers_.row(y)[w]));
    }
  }
  return count;
}

bool
GapGrid::findGaps(double diameter)
{
  num_gaps_ = 0;
  runs_.clear();
  // A disc one cell narrower is empty wherever in their cells the points are.
  const double narrower = std::max(2.0 * cell_, diameter - 2.0 * cell_);
  if (!findCenters(narrower)) return false;
  spreadByDisc(centers_, 0.5 * narrower / cell_, scratch_, empty_);
  findRuns();
  joinRuns();
  numberGaps();
  return true;
}

double
GapGrid::numMissing(int x, int y, double diameter) const
{
  constexpr double kPi = 3.14159265358979323846;
  const int last_cell = occupied_.side() - 1;
  const int reach = static_cast<int>(std::lround(diameter / cell_));
  const int first = std::max(0, x - reach), last = std::min(last_cell, x + reach);
  std::uint64_t cells = 0, held = 0;
  for (int row = std::max(0, y - reach); row <= std::min(last_cell, y + reach); ++row) {
    for (int w = first >> 6; w <= last >> 6; ++w) {
      const int low = std::max(0, first - 64 * w), high = std::min(63, last - 64 * w);
      const std::uint64_t window = (std::uint64_t{2} << high) - (std::uint64_t{1} << low);
      const std::uint64_t known = window & ~beyond_.row(row)[w];
      cells += static_cast<std::uint64_t>(__builtin_popcountll(known));
      held += static_cast<std::uint64_t>(__builtin_popcountll(known & occupied_.row(row)[w]));
    }
  }
  const double disc = 0.25 * kPi * diameter * diameter / (cell_ * cell_);
  const double around = std::max(1.0, static_cast<double>(cells) - disc);
  return -disc * std::log1p(-std::min(0.999, static_cast<double>(held) / around));
}

void
GapGrid::addDiscs(const BitRows& middles, double diameter, BitRows& cells)
{
  spreadByDisc(middles, 0.5 * diameter / cell_, scratch_, discs_);
  uniteRows(discs_, cells, cells);
}

void
GapGrid::findRuns()
{
  const int side = empty_.side();
  for (int y = 0; y < side; ++y) {
    const std::uint64_t* row = empty_.row(y);
    for (int x = 0; x < side;) {
      const std::uint64_t rest = row[x >> 6] >> (x & 63);
      if (rest == 0) {
        x = (x | 63) + 1;
        continue;
      }
      const int first = x + lowestBit(rest);
      x = first;
      while (x < side && empty_.test(x, y)) ++x;
      runs_.push_back({y, first, x - 1, 0});
    }
  }
}

int
GapGrid::rootOf(int run)
{
  int* parents = parents_.data();
  while (parents[run] != run) run = parents[run] = parents[parents[run]];
  return run;
}

/** Makes runs that touch, also at corners, one gap. */
void
GapGrid::joinRuns()
{
  parents_.resize(runs_.size());
  std::size_t above = 0;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    parents_[k] = static_cast<int>(k);
    while (runs_[above].y < runs_[k].y - 1) ++above;
    for (std::size_t a = above; runs_[a].y < runs_[k].y; ++a) {
      if (runs_[a].last + 1 < runs_[k].first || runs_[a].first > runs_[k].last + 1) continue;
      const int one = rootOf(static_cast<int>(a)), other = rootOf(static_cast<int>(k));
      parents_[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
    }
  }
}

void
GapGrid::numberGaps()
{
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const auto root = static_cast<std::size_t>(rootOf(static_cast<int>(k)));
    runs_[k].gap = root == k ? num_gaps_++ : runs_[root].gap;
  }
}

}  // namespace pcl_slim::detail

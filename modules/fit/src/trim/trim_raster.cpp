// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_raster.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kFine = 8;        ///< parts of a cell that a point's place is told in
constexpr int kUnit = 64;       ///< depth of one cell
constexpr int kMostHalf = 95;   ///< cells from the middle of a raster: three words a row
constexpr int kMostDepth = 4;   ///< cells: beyond, depths decide nothing
constexpr int kMostHeight = 8;  ///< cells: likewise outside

/** One step of smoothing, by (1 4 6 4 1) / 16: variance one cell squared. */
std::int16_t
smoothed(int a, int b, int c, int d, int e)
{
  return static_cast<std::int16_t>((a + e + 4 * (b + d) + 6 * c + 8) >> 4);
}

}  // namespace

/** Half widths, in parts of a cell, of the rows of a disc: for each place of its middle in a cell, the
 * span rows from so many above the middle's on; -1 where the disc has none. */
void
TrimRaster::cutDisc(double reach, int rows, int span)
{
  run_halves_.resize(static_cast<std::size_t>(kFine * span));
  for (int k = 0; k < kFine * span; ++k) {
    const int part = k / span;
    const double up = k % span - rows - static_cast<double>(part) / kFine;
    const double half_sq = reach * reach - up * up;
    run_halves_[static_cast<std::size_t>(k)] =
        half_sq < 0.0 ? -1 : static_cast<int>(kFine * std::sqrt(half_sq));
  }
}

/** Marks every cell nearer than reach (cells) to a point: in each row a run of cells. */
void
TrimRaster::cover(const SheetPoints& points, double reach)
{
  const int rows = static_cast<int>(std::ceil(reach)), span = 2 * rows + 2;
  cutDisc(reach, rows, span);
  const auto per_unit = static_cast<float>(kFine / cell_);
  const float middle = static_cast<float>(kFine * half_) + 0.5f;
  for (std::size_t i = 0; i < points.count; ++i) {
    const int x = static_cast<int>(points.u[i] * per_unit + middle);
    const int y = static_cast<int>(points.v[i] * per_unit + middle);
    const int* halves = run_halves_.data() + (y % kFine) * span;
    const int first_row = y / kFine - rows;
    for (int k = std::max(0, -first_row); k < std::min(span, side_ - first_row); ++k) {
      const int first = std::max(0, (x - halves[k] + kFine - 1) / kFine);
      const int last = std::min(side_ - 1, (x + halves[k]) / kFine);
      if (halves[k] >= 0 && first <= last) covered_.setRun(first_row + k, first, last);
    }
  }
}

/** Squared distances, in cells and up to cap, of each cell to the next uncovered one of its row. */
void
TrimRaster::findRowDistances(int cap)
{
  row_distance_sq_.resize(static_cast<std::size_t>(side_ * side_));
  row_has_gap_.assign(static_cast<std::size_t>(side_), 0);
  for (int y = 0; y < side_; ++y) {
    std::int16_t* distance = row_distance_sq_.data() + y * side_;
    const std::uint64_t* words = covered_.row(y);
    int last = cap;
    for (int x = 0; x < side_; ++x) {
      const bool covered = (words[x >> 6] >> (x & 63) & 1) != 0;
      last = covered ? std::min(last + 1, cap) : 0;
      row_has_gap_[static_cast<std::size_t>(y)] |= static_cast<std::uint8_t>(!covered);
      distance[x] = static_cast<std::int16_t>(last);
    }
    last = cap;
    for (int x = side_ - 1; x >= 0; --x) {
      last = std::min<int>(distance[x], std::min(last + 1, cap));
      distance[x] = static_cast<std::int16_t>(last);
    }
  }
  for (std::int16_t& distance : row_distance_sq_) {
    distance = static_cast<std::int16_t>(distance * distance);
  }
}

/** The same of all rows, from those of each: the least over the rows about. */
void
TrimRaster::spreadDistances(int cap)
{
  distance_sq_.assign(static_cast<std::size_t>(side_ * side_),
                      static_cast<std::int16_t>(cap * cap));
  for (int y = 0; y < side_; ++y) {
    if (!row_has_gap_[static_cast<std::size_t>(y)]) continue;
    const std::int16_t* from = row_distance_sq_.data() + y * side_;
    for (int row = std::max(0, y - cap + 1); row < std::min(side_, y + cap); ++row) {
      const auto up_sq = static_cast<std::int16_t>((row - y) * (row - y));
      std::int16_t* to = distance_sq_.data() + row * side_;
      for (int x = 0; x < side_; ++x) {
        to[x] = std::min(to[x], static_cast<std::int16_t>(from[x] + up_sq));
      }
    }
  }
}

/** Depths from the distances to uncovered cells: the distance less offset, and -offset there. */
void
TrimRaster::findDepths(int cap, double offset)
{
  depth_of_sq_.resize(static_cast<std::size_t>(cap * cap) + 1);
  for (std::size_t k = 0; k < depth_of_sq_.size(); ++k) {
    const double depth = std::sqrt(static_cast<double>(k)) - offset;
    const double clamped = std::clamp<double>(depth, -kMostHeight, kMostDepth);
    depth_of_sq_[k] = static_cast<std::int16_t>(std::lround(kUnit * clamped));
  }
  depth_.resize(distance_sq_.size());
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    depth_[k] = depth_of_sq_[static_cast<std::size_t>(distance_sq_[k])];
  }
}

void
TrimRaster::smoothRows()
{
  scratch_.resize(static_cast<std::size_t>(side_) + 4);
  for (int y = 0; y < side_; ++y) {
    std::int16_t* row = depth_.data() + y * side_;
    std::fill_n(scratch_.begin(), 2, row[0]);
    std::copy_n(row, side_, scratch_.begin() + 2);
    std::fill_n(scratch_.begin() + side_ + 2, 2, row[side_ - 1]);
    const std::int16_t* s = scratch_.data();
    for (int x = 0; x < side_; ++x) row[x] = smoothed(s[x], s[x + 1], s[x + 2], s[x + 3], s[x + 4]);
  }
}

void
TrimRaster::smoothColumns()
{
  scratch_ = depth_;
  const auto row = [&](int y) { return scratch_.data() + std::clamp(y, 0, side_ - 1) * side_; };
  for (int y = 0; y < side_; ++y) {
    const std::int16_t *a = row(y - 2), *b = row(y - 1), *c = row(y), *d = row(y + 1),
                       *e = row(y + 2);
    std::int16_t* to = depth_.data() + y * side_;
    for (int x = 0; x < side_; ++x) to[x] = smoothed(a[x], b[x], c[x], d[x], e[x]);
  }
}

bool
TrimRaster::measure(const SheetPoints& points, const KnownRegion& known, const TrimScale& scale,
                    const TrimConstants& constants)
{
  cell_ = std::max(constants.cell * scale.spacing, constants.known / kMostHalf);
  half_ = static_cast<int>(std::ceil(constants.known / cell_));
  side_ = 2 * half_ + 1;
  const double reach = 0.5 * scale.hole / cell_;
  covered_.reset(side_);
  cover(points, reach);
  known.markBeyond(cell_, half_, covered_);
  const double offset = reach - scale.growth / cell_;
  const int cap = static_cast<int>(std::ceil(offset)) + kMostDepth;
  findRowDistances(cap);
  const bool covered = std::all_of(row_has_gap_.begin(), row_has_gap_.end(),
                                   [](std::uint8_t gap) { return gap == 0; });
  if (covered) return false;
  spreadDistances(cap);
  findDepths(cap, offset);
  for (int pass = 0; pass < 2; ++pass) {
    smoothRows();
    smoothColumns();
  }
  return true;
}

bool
TrimRaster::hasGapWithin(const KnownRegion& sure)
{
  unsure_.reset(side_);
  sure.markBeyond(cell_, half_, unsure_);
  const std::size_t words = covered_.wordsPerRow();
  const std::uint64_t in_last = (std::uint64_t{2} << ((side_ - 1) & 63)) - 1;
  for (int y = 0; y < side_; ++y) {
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t gap = ~(covered_.row(y)[w] | unsure_.row(y)[w]);
      if ((w + 1 < words ? gap : gap & in_last) != 0) return true;
    }
  }
  return false;
}

int
TrimRaster::leastDepth(double share) const
{
  const double reach = share / cell_;
  int least = kUnit * kMostDepth;
  for (int y = 0; y < side_; ++y) {
    const double half_sq = reach * reach - (y - half_) * (y - half_);
    if (half_sq < 0.0) continue;
    const int half = static_cast<int>(std::sqrt(half_sq));
    const auto begin = depth_.begin() + y * side_ + half_;
    least = std::min<int>(least, *std::min_element(begin - half, begin + half + 1));
  }
  return least;
}

/** Depth at a place in 256ths of a cell, times 2^16, by bilinear interpolation. */
int
TrimRaster::depthAt(int x_fixed, int y_fixed) const
{
  const int x = std::clamp(x_fixed >> 8, 0, side_ - 2), y = std::clamp(y_fixed >> 8, 0, side_ - 2);
  const int dx = x_fixed - (x << 8), dy = y_fixed - (y << 8);
  const std::int16_t* at = depth_.data() + y * side_ + x;
  const int below = at[0] * (256 - dx) + at[1] * dx;
  const int above = at[side_] * (256 - dx) + at[side_ + 1] * dx;
  return below * (256 - dy) + above * dy;
}

void
TrimRaster::fillMap(int side, std::uint8_t* bits) const
{
  const auto place = [&](int node) {
    const double coordinate = 2.0 * node / (side - 1) - 1.0;
    return static_cast<int>(std::lround(256.0 * (coordinate / cell_ + half_)));
  };
  for (int row = 0, k = 0; row < side; ++row) {
    const int y = place(row);
    for (int column = 0; column < side; ++column, ++k) {
      const bool inside = depthAt(place(column), y) > 0;
      bits[k >> 3] |= static_cast<std::uint8_t>(inside << (k & 7));
    }
  }
}

}  // namespace pcl_slim::detail

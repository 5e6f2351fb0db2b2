// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/trim_map.h"

namespace pcl_slim::detail {

namespace {

constexpr int kFine = 8;       ///< parts of a cell that a point's place is rounded to
constexpr int kMostHalf = 95;  ///< cells from the middle of a raster: three words a row
constexpr int kMostWords = 3;
constexpr std::size_t kFewPlaces = 128;  ///< fewer are looked at one by one
constexpr std::size_t kFewPoints =
    256;                        ///< all gaps of fewer points are measured together; only for speed
constexpr int kLanes = 16;      ///< columns that loops take together
constexpr int kMostDepth = 4;   ///< cells: beyond, depths decide nothing
constexpr int kMostHeight = 8;  ///< cells: likewise outside

constexpr std::uint16_t kBits[kLanes] = {1,       1 << 1,  1 << 2,  1 << 3, 1 << 4,  1 << 5,
                                         1 << 6,  1 << 7,  1 << 8,  1 << 9, 1 << 10, 1 << 11,
                                         1 << 12, 1 << 13, 1 << 14, 1 << 15};

/** Keeps the set bits whose neighbours in the row are set too; those beyond the row are. */
void erodeRow(const std::uint64_t* from, std::size_t words, std::uint64_t* to) {
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t before = w > 0 ? from[w - 1] >> 63 : 1;
    const std::uint64_t after = w + 1 < words ? from[w + 1] << 63 : std::uint64_t{1} << 63;
    to[w] = from[w] & (from[w] << 1 | before) & (from[w] >> 1 | after);
  }
}

/** Likewise in all rows. */
void erodeRows(const BitRows& from, BitRows& to) {
  to.reset(from.side());
  if (from.wordsPerRow() > 1) {
    for (int y = 0; y < from.side(); ++y) erodeRow(from.row(y), from.wordsPerRow(), to.row(y));
    return;
  }
  const std::uint64_t* rows = from.row(0);  // one word each: vectorised
  for (std::size_t y = 0; y < from.numWords(); ++y)
    to.row(0)[y] = rows[y] & (rows[y] << 1 | 1) & (rows[y] >> 1 | std::uint64_t{1} << 63);
}

/** Sets the bits next to set ones. */
void widenRow(std::uint64_t* row, std::size_t words) {
  std::uint64_t before = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t old = row[w], after = w + 1 < words ? row[w + 1] << 63 : 0;
    row[w] = old | (old << 1 | before) | (old >> 1 | after);
    before = old >> 63;
  }
}

/** One step of smoothing, by (1 4 6 4 1) / 16: variance one cell squared. */
std::int16_t smoothed(int a, int b, int c, int d, int e) {
  return static_cast<std::int16_t>((a + e + 4 * (b + d) + 6 * c + 8) >> 4);
}

/** Adds a value to the columns whose bits are set. */
void addAtBits(const std::uint64_t* row, int columns, std::int16_t value, std::int16_t* sums) {
  for (int x = 0; x < columns; x += kLanes) {
    const auto bits = static_cast<std::uint16_t>(row[x >> 6] >> (x & 63));
    for (int k = 0; k < kLanes; ++k)
      sums[x + k] = static_cast<std::int16_t>(sums[x + k] + ((bits & kBits[k]) != 0 ? value : 0));
  }
}

}  // namespace

/** Half widths, in parts of a cell, of the rows of a disc: for each place of its middle in a cell,
 * all rows, the first disc_rows_ below the middle's; -1 where the disc has none. */
void TrimRaster::cutDisc(double reach) {
  disc_rows_ = static_cast<int>(std::ceil(reach));
  const int span = 2 * disc_rows_ + 2;
  run_halves_.resize(static_cast<std::size_t>(kFine * span));
  for (int k = 0; k < kFine * span; ++k) {
    const int part = k / span;
    const double up = k % span - disc_rows_ - static_cast<double>(part) / kFine;
    const double half_sq = reach * reach - up * up;
    run_halves_[static_cast<std::size_t>(k)] =
        half_sq < 0.0 ? -1 : static_cast<int>(kFine * std::sqrt(half_sq));
  }
}

void TrimRaster::setScale(const TrimScale& scale) {
  cell_ = std::max(kTrim.cell * scale.spacing, kTrim.known / kMostHalf);
  reach_ = 0.5 * scale.hole / cell_;
  growth_ = scale.growth / cell_;
  half_ = static_cast<int>(std::ceil(kTrim.known / cell_));
  side_ = 2 * half_ + 1;
}

/** Sets, in eroded_[0], the cells without points. */
void TrimRaster::markEmpty(const SheetPoints& points) {
  BitRows& empty = eroded_[0];
  empty.reset(side_);
  const auto per_unit = static_cast<float>(1.0 / cell_);
  const float middle = static_cast<float>(half_) + 0.5f;
  for (std::size_t i = 0; i < points.count; ++i) {
    empty.set(static_cast<int>(points.u[i] * per_unit + middle),
              static_cast<int>(points.v[i] * per_unit + middle));
  }
  std::uint64_t* words = empty.row(0);
  for (std::size_t w = 0; w < empty.numWords(); ++w) words[w] = ~words[w];
}

/** Clears, in filled_, the cells around which all cells are empty that a disc contains whole. */
void TrimRaster::markEmptyDiscs(const SheetPoints& points) {
  whole_halves_.clear();
  for (double up = 0.5; reach_ * reach_ - up * up >= 0.25; up += 1.0)
    whole_halves_.push_back(static_cast<std::size_t>(std::sqrt(reach_ * reach_ - up * up) - 0.5));
  const std::size_t widest = whole_halves_.empty() ? 0 : whole_halves_[0];
  if (eroded_.size() <= widest) eroded_.resize(widest + 1);
  markEmpty(points);
  for (std::size_t k = 1; k <= widest; ++k) erodeRows(eroded_[k - 1], eroded_[k]);
  filled_.reset(side_);
  std::uint64_t* to = filled_.row(0);
  const std::size_t all = filled_.numWords();
  for (std::size_t row = 0; row < whole_halves_.size(); ++row) {
    const std::uint64_t* from = eroded_[whole_halves_[row]].row(0);
    const std::size_t shift = std::min(row * filled_.wordsPerRow(), all);  // nothing is beyond
    for (std::size_t w = shift; w < all; ++w) to[w] |= ~from[w - shift];
    for (std::size_t w = shift; w < all; ++w) to[w - shift] |= ~from[w];
  }
}

/** Sets, in near_gaps_, the cells at most a reach from those set, along rows and across. */
void TrimRaster::markNear(const BitRows& cells, int reach) {
  const std::size_t words = cells.wordsPerRow();
  std::uint64_t row[kMostWords] = {};
  near_gaps_.reset(side_);
  for (int y = 0; y < side_; ++y) {
    std::copy_n(cells.row(y), words, row);
    if (std::all_of(row, row + words, [](std::uint64_t word) { return word == 0; })) continue;
    for (int k = 0; k < reach; ++k) widenRow(row, words);
    for (int to = std::max(0, y - reach); to <= std::min(side_ - 1, y + reach); ++to) {
      for (std::size_t w = 0; w < words; ++w) near_gaps_.row(to)[w] |= row[w];
    }
  }
}

/** Likewise from uncovered cells. */
void TrimRaster::markNearGaps(int reach) {
  const std::size_t words = covered_.wordsPerRow();
  scratch_bits_.reset(side_);
  for (int y = 0; y < side_; ++y) {
    std::uint64_t* row = scratch_bits_.row(y);
    for (std::size_t w = 0; w < words; ++w) row[w] = ~covered_.row(y)[w];
    row[words - 1] &= covered_.inLastWord();
  }
  markNear(scratch_bits_, reach);
}

void TrimRaster::findRims(const SheetPoints& points,
                          const std::vector<std::array<double, 2>>& places,
                          std::vector<std::uint32_t>& rims) {
  const auto per_unit = static_cast<float>(1.0 / cell_);
  const float middle = static_cast<float>(half_) + 0.5f;
  const auto cellOf = [&](float value) { return static_cast<int>(value * per_unit + middle); };
  scratch_bits_.reset(side_);
  for (const auto& [u, v] : places)
    scratch_bits_.set(cellOf(static_cast<float>(u)), cellOf(static_cast<float>(v)));
  markNear(scratch_bits_, static_cast<int>(std::ceil(reach_)) + 1);
  rims.clear();
  for (std::size_t i = 0; i < points.count; ++i) {
    if (near_gaps_.has(cellOf(points.u[i]), cellOf(points.v[i])))
      rims.push_back(static_cast<std::uint32_t>(i));
  }
}

/** Covers the places of the disc of cutDisc() about a point, a run of cells in each row.
 * \param[in] x,y of the point, in parts of a cell */
void TrimRaster::coverDisc(int x, int y) {
  const int span = 2 * disc_rows_ + 2;
  const int* halves = run_halves_.data() + (y % kFine) * span;
  const int first_row = y / kFine - disc_rows_;
  for (int k = std::max(0, -first_row); k < std::min(span, side_ - first_row); ++k) {
    if (halves[k] < 0) continue;
    const int first = std::max(0, x - halves[k] + kFine - 1) / kFine;
    const int last = std::min(side_ - 1, (x + halves[k]) / kFine);
    if (first <= last) covered_.setRun(first_row + k, first, last);
  }
}

/** Covers the places that points are nearer to than the reach, where any are left. */
void TrimRaster::coverGaps(const SheetPoints& points) {
  cutDisc(reach_);
  markNearGaps(disc_rows_ + 1);
  const auto per_unit = static_cast<float>(kFine / cell_);
  const float middle = static_cast<float>(kFine * half_) + 0.5f;
  for (std::size_t i = 0; i < points.count; ++i) {
    const int x = static_cast<int>(points.u[i] * per_unit + middle);
    const int y = static_cast<int>(points.v[i] * per_unit + middle);
    if (near_gaps_.has(x / kFine, y / kFine)) coverDisc(x, y);
  }
}

/** The cells that are neither covered nor unsure. */
void TrimRaster::listGaps(std::vector<std::array<double, 2>>& places) const {
  places.clear();
  for (int y = 0; y < side_; ++y) {
    for (std::size_t w = 0; w < covered_.wordsPerRow(); ++w) {
      std::uint64_t gaps = ~(covered_.row(y)[w] | unsure_.row(y)[w]);
      if (w + 1 == covered_.wordsPerRow()) gaps &= covered_.inLastWord();
      for (; gaps != 0; gaps &= gaps - 1) {
        const int x = static_cast<int>(64 * w) + __builtin_ctzll(gaps);
        places.push_back({cell_ * (x - half_), cell_ * (y - half_)});
      }
    }
  }
}

/** Removes the places that a point is nearer to than the reach. */
void TrimRaster::dropCovered(const SheetPoints& points,
                             std::vector<std::array<double, 2>>& places) const {
  const double reach_sq = reach_ * reach_ * cell_ * cell_;
  const auto isCovered = [&](const std::array<double, 2>& place) {
    const auto u = static_cast<float>(place[0]), v = static_cast<float>(place[1]);
    return kernels::nearestSq(points, u, v) < reach_sq;
  };
  places.erase(std::remove_if(places.begin(), places.end(), isCovered), places.end());
}

/** Whether a cell is neither covered nor unsure. */
bool TrimRaster::hasGap() const {
  const std::size_t words = covered_.wordsPerRow();
  const std::uint64_t *covered = covered_.row(0), *unsure = unsure_.row(0);
  std::uint64_t any = 0;
  if (words == 1) {
    for (std::size_t w = 0; w < covered_.numWords(); ++w) any |= ~(covered[w] | unsure[w]);
    return (any & covered_.inLastWord()) != 0;
  }
  for (std::size_t w = 0; w < covered_.numWords(); ++w) {
    const std::uint64_t in_row = (w + 1) % words == 0 ? covered_.inLastWord() : ~std::uint64_t{0};
    any |= ~(covered[w] | unsure[w]) & in_row;
  }
  return any != 0;
}

void TrimRaster::findGaps(const SheetPoints& points, const KnownRegion& sure,
                          const TrimScale& scale, std::vector<std::array<double, 2>>& places) {
  places.clear();
  setScale(scale);
  markEmptyDiscs(points);
  covered_ = filled_;
  all_covered_ = points.count < kFewPoints;
  unsure_.reset(side_);
  sure.markBeyondCircle(cell_, half_, unsure_);
  if (!hasGap()) return;
  sure.markBeyond(cell_, half_, unsure_);
  if (!hasGap()) return;
  listGaps(places);
  if (places.size() < kFewPlaces && !all_covered_) {
    dropCovered(points, places);
  } else if (!places.empty()) {
    if (!all_covered_) covered_.add(unsure_);
    coverGaps(points);
    listGaps(places);
  }
}

/** Squared distances, in cells and up to cap, of a row's cells to the next uncovered one of the
 * row. A cell is as far from one as there are erosions that it outlasts. \return whether there is
 * one. */
bool TrimRaster::findDistances(int y, int cap, std::int16_t* distance_sq) const {
  const std::size_t words = covered_.wordsPerRow();
  std::uint64_t rows[2][kMostWords] = {};
  std::uint64_t *row = rows[0], *next = rows[1];
  std::copy_n(covered_.row(y), words, row);
  row[words - 1] |= ~covered_.inLastWord();
  if (std::all_of(row, row + words, [](std::uint64_t word) { return ~word == 0; })) {
    std::fill_n(distance_sq, stride_, static_cast<std::int16_t>(cap * cap));
    return false;
  }
  const auto isSet = [](std::uint64_t word) { return word != 0; };
  for (int k = 0; k < cap && std::any_of(row, row + words, isSet); ++k) {
    addAtBits(row, stride_, static_cast<std::int16_t>(2 * k + 1), distance_sq);
    erodeRow(row, words, next);
    std::swap(row, next);
  }
  return true;
}

void TrimRaster::findRowDistances(int cap) {
  stride_ = (side_ + kLanes - 1) / kLanes * kLanes;
  row_distance_sq_.assign(static_cast<std::size_t>(side_ * stride_), 0);
  row_has_gap_.resize(static_cast<std::size_t>(side_));
  for (int y = 0; y < side_; ++y)
    row_has_gap_[static_cast<std::size_t>(y)] =
        findDistances(y, cap, row_distance_sq_.data() + y * stride_);
}

/** The same of all rows, from those of each: the least over the rows about. */
void TrimRaster::spreadDistances(int cap) {
  distance_sq_.assign(row_distance_sq_.size(), static_cast<std::int16_t>(cap * cap));
  for (int y = 0; y < side_; ++y) {
    if (!row_has_gap_[static_cast<std::size_t>(y)]) continue;
    const std::int16_t* from = row_distance_sq_.data() + y * stride_;
    for (int row = std::max(0, y - cap + 1); row < std::min(side_, y + cap); ++row) {
      const auto up_sq = static_cast<std::int16_t>((row - y) * (row - y));
      std::int16_t* to = distance_sq_.data() + row * stride_;
      for (int x = 0; x < stride_; ++x) {
        to[x] = std::min(to[x], static_cast<std::int16_t>(from[x] + up_sq));
      }
    }
  }
}

/** Depths from the distances to uncovered cells: the distance less offset, and -offset there. */
void TrimRaster::findDepths(int cap, double offset) {
  depth_of_sq_.resize(static_cast<std::size_t>(cap * cap) + 1);
  for (std::size_t k = 0; k < depth_of_sq_.size(); ++k) {
    const double depth = std::sqrt(static_cast<double>(k)) - offset;
    const double clamped = std::clamp<double>(depth, -kMostHeight, kMostDepth);
    depth_of_sq_[k] = static_cast<std::int16_t>(std::lround(kDepthUnit * clamped));
  }
  depth_.resize(distance_sq_.size());
  for (std::size_t k = 0; k < depth_.size(); ++k) {
    depth_[k] = depth_of_sq_[static_cast<std::size_t>(distance_sq_[k])];
  }
}

void TrimRaster::smoothRows() {
  scratch_.resize(static_cast<std::size_t>(stride_) + 4);
  for (int y = 0; y < side_; ++y) {
    std::int16_t* row = depth_.data() + y * stride_;
    std::fill_n(scratch_.begin(), 2, row[0]);
    std::copy_n(row, side_, scratch_.begin() + 2);
    std::fill(scratch_.begin() + side_ + 2, scratch_.end(), row[side_ - 1]);
    const std::int16_t* s = scratch_.data();
    for (int x = 0; x < stride_; ++x)
      row[x] = smoothed(s[x], s[x + 1], s[x + 2], s[x + 3], s[x + 4]);
  }
}

void TrimRaster::smoothColumns() {
  scratch_ = depth_;
  const auto row = [&](int y) { return scratch_.data() + std::clamp(y, 0, side_ - 1) * stride_; };
  for (int y = 0; y < side_; ++y) {
    const std::int16_t *a = row(y - 2), *b = row(y - 1), *c = row(y), *d = row(y + 1),
                       *e = row(y + 2);
    std::int16_t* to = depth_.data() + y * stride_;
    for (int x = 0; x < stride_; ++x) to[x] = smoothed(a[x], b[x], c[x], d[x], e[x]);
  }
}

void TrimRaster::measureDepths(const SheetPoints& points, const KnownRegion& known) {
  if (!all_covered_) {
    covered_ = filled_;
    coverGaps(points);
  }
  known.markBeyond(cell_, half_, covered_);
  const double offset = reach_ - growth_;
  const int cap = static_cast<int>(std::ceil(offset)) + kMostDepth;
  findRowDistances(cap);
  spreadDistances(cap);
  findDepths(cap, offset);
  for (int pass = 0; pass < 2; ++pass) {
    smoothRows();
    smoothColumns();
  }
}

int TrimRaster::leastDepth(double share) const {
  const double reach = share / cell_;
  int least = kDepthUnit * kMostDepth;
  for (int y = 0; y < side_; ++y) {
    const double half_sq = reach * reach - (y - half_) * (y - half_);
    if (half_sq < 0.0) continue;
    const int half = static_cast<int>(std::sqrt(half_sq));
    const auto begin = depth_.begin() + y * stride_ + half_;
    least = std::min<int>(least, *std::min_element(begin - half, begin + half + 1));
  }
  return least;
}

/** Depth at a place in 256ths of a cell, times 2^16, by bilinear interpolation. */
int TrimRaster::depthAt(int x_fixed, int y_fixed) const {
  const int x = std::clamp(x_fixed >> 8, 0, side_ - 2), y = std::clamp(y_fixed >> 8, 0, side_ - 2);
  const int dx = x_fixed - (x << 8), dy = y_fixed - (y << 8);
  const std::int16_t* at = depth_.data() + y * stride_ + x;
  const int below = at[0] * (256 - dx) + at[1] * dx;
  const int above = at[stride_] * (256 - dx) + at[stride_ + 1] * dx;
  return below * (256 - dy) + above * dy;
}

void TrimRaster::fillMap(int side, std::uint8_t* bits) const {
  std::array<int, TrimMap::kMostSide> places;  // in 256ths of a cell
  for (int node = 0; node < side; ++node) {
    const double coordinate = 2.0 * node / (side - 1) - 1.0;
    places[static_cast<std::size_t>(node)] =
        static_cast<int>(std::lround(256.0 * (coordinate / cell_ + half_)));
  }
  for (int row = 0, k = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column, ++k) {
      const bool inside = depthAt(places[static_cast<std::size_t>(column)],
                                  places[static_cast<std::size_t>(row)]) > 0;
      bits[k >> 3] |= static_cast<std::uint8_t>(inside << (k & 7));
    }
  }
}

}  // namespace pcl_slim::detail

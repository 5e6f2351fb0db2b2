// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/detail/center_grid.h"

#include <cmath>
#include <limits>

namespace pcl_slim::detail {

namespace {

// Cells and their neighbours are counted in 21 bits an axis. Centres outside [-1, 1] share a
// cell at the rim.
constexpr int kAxisBits = 21;
constexpr double kNarrowest = 0x1p-19;
constexpr double kLastCell = 0x1p21 - 4;
constexpr std::size_t kSpare = 16;  ///< values that kernels may touch behind the last
constexpr int kDigitBits = 11;
constexpr std::size_t kFewEntries = 300;  ///< are sorted by comparing

using Entry = CenterGrid::Entry;

constexpr std::int64_t kAxisMask = (std::int64_t{1} << kAxisBits) - 1;

/** The code whose coordinates are the least of each axis. */
std::int64_t
leastCode(const std::vector<Entry>& entries)
{
  std::int64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t mask = kAxisMask << (axis * kAxisBits);
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (const Entry& e : entries) least = std::min(least, e.cell & mask);
    code += least;
  }
  return code;
}

/** Some bits of a code, counted from a base. */
struct Digit {
  std::int64_t base, mask;
  int shift;

  std::size_t of(const Entry& e) const
  {
    return static_cast<std::size_t>(((e.cell - base) >> shift) & mask);
  }
};

/** One stable counting pass. sorted and next are room to work in. */
void
sortByDigit(const Digit& digit, std::vector<Entry>& entries, std::vector<Entry>& sorted,
            std::vector<std::uint32_t>& next)
{
  next.assign(static_cast<std::size_t>(digit.mask) + 2, 0);
  for (const Entry& e : entries) ++next[digit.of(e) + 1];
  for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
  for (const Entry& e : entries) sorted[next[digit.of(e)]++] = e;
  entries.swap(sorted);
}

/** Sorts by the digits in which codes differ, counted from the least coordinate of each axis. */
void
sortByDigits(std::vector<Entry>& entries)
{
  const std::int64_t base = leastCode(entries);
  std::int64_t differing = 0;
  for (const Entry& e : entries) differing |= e.cell - base;
  std::vector<Entry> sorted(entries.size());
  std::vector<std::uint32_t> next;
  for (int axis = 0; axis < 3; ++axis) {
    for (int low = 0; low < kAxisBits; low += kDigitBits) {
      const int bits = std::min(kDigitBits, kAxisBits - low), shift = axis * kAxisBits + low;
      const std::int64_t mask = (std::int64_t{1} << bits) - 1;
      if (((differing >> shift) & mask) != 0)
        sortByDigit({base, mask, shift}, entries, sorted, next);
    }
  }
}

}  // namespace

CenterGrid::CenterGrid(const SLIMSurface& surface, const std::vector<std::uint32_t>& members,
                       float width)
    : inverse_(1.0 / std::max<double>(width, kNarrowest))
{
  const std::vector<Entry> entries = sortedByCell(surface, members);
  codes_.reserve(entries.size());
  members_.reserve(entries.size());
  for (auto* column : {&x_, &y_, &z_}) column->reserve(entries.size() + kSpare);
  for (const auto& [cell, i] : entries) {
    codes_.push_back(cell);
    members_.push_back(i);
    x_.push_back(surface.cx[i]);
    y_.push_back(surface.cy[i]);
    z_.push_back(surface.cz[i]);
  }
  for (auto* column : {&x_, &y_, &z_}) column->resize(entries.size() + kSpare, 0.0f);
}

std::int64_t
CenterGrid::cell(float local) const
{
  return std::llround(std::clamp((local + 1.0) * inverse_, 0.0, kLastCell)) + 1;
}

std::vector<Entry>
CenterGrid::sortedByCell(const SLIMSurface& surface,
                         const std::vector<std::uint32_t>& surfels) const
{
  std::vector<Entry> entries;
  entries.reserve(surfels.size());
  for (const std::uint32_t i : surfels) {
    entries.push_back({code(cell(surface.cx[i]), cell(surface.cy[i]), cell(surface.cz[i])), i});
  }
  if (entries.size() > kFewEntries) {
    sortByDigits(entries);
  } else {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.cell < b.cell; });
  }
  return entries;
}

std::vector<Entry>
CenterGrid::entries() const
{
  std::vector<Entry> entries(size());
  for (std::size_t at = 0; at < size(); ++at) entries[at] = {codes_[at], members_[at]};
  return entries;
}

const CenterGrid::Ranges&
CenterGrid::Walk::around(std::int64_t cell)
{
  if (cell == last_) return rows_;
  for (std::int64_t row = 0; row < 9; ++row) {
    const std::int64_t low = cell + code(row / 3 - 1, row % 3 - 1, -1);
    ColumnRange& range = rows_[static_cast<std::size_t>(row)];
    if (last_ < 0) {
      const auto it = std::lower_bound(codes_.begin(), codes_.end(), low);
      range.begin = range.end = static_cast<std::size_t>(it - codes_.begin());
    }
    while (range.begin < codes_.size() && codes_[range.begin] < low) ++range.begin;
    range.end = std::max(range.begin, range.end);
    while (range.end < codes_.size() && codes_[range.end] <= low + 2) ++range.end;
  }
  last_ = cell;
  return rows_;
}

void
CenterGrid::findWithin(const Ranges& ranges, const float place[3], float limit_sq, Near& near) const
{
  std::size_t most = kSpare;
  for (const ColumnRange& range : ranges) most += range.end - range.begin;
  if (near.places.size() < most) {
    near.places.resize(most);
    near.distances_sq.resize(most);
  }
  near.count =
      kernels::entriesWithin(x_.data(), y_.data(), z_.data(), ranges.data(), ranges.size(), place,
                             limit_sq, near.places.data(), near.distances_sq.data());
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "sides/side_cells.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kTask = 4096;  ///< points a thread takes at a time
constexpr std::int64_t kLast = (1 << kMortonBits) - 1;

using Place = std::array<std::int64_t, 3>;  ///< of a cell along each axis

Place
placeOf(const Vector3& p, double width)
{
  Place place;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cell = std::floor((p[a] + 0.5) / width);
    place[a] = static_cast<std::int64_t>(std::clamp(cell, 0.0, static_cast<double>(kLast)));
  }
  return place;
}

std::uint64_t
codeOf(const Place& place)
{
  std::uint64_t code = 0;
  for (std::size_t a = 0; a < 3; ++a)
    code |= spreadBits(static_cast<std::uint64_t>(place[a])) << (2 - a);
  return code;
}

std::size_t
hashOf(std::uint64_t code)
{
  code *= 0x9e3779b97f4a7c15ULL;
  return static_cast<std::size_t>(code ^ code >> 32);
}

CellMoments
momentsOf(const PointStore& store, const std::uint32_t* begin, const std::uint32_t* end)
{
  CellMoments m;
  m.count = static_cast<double>(end - begin);
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const Vector3 p = store.position(*i);
    for (std::size_t a = 0; a < 3; ++a) m.mean[a] += p[a] / m.count;
  }
  for (const std::uint32_t* i = begin; i != end; ++i) {
    const Vector3 d = subtract(store.position(*i), m.mean);
    for (std::size_t a = 0, k = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b, ++k) m.covariance[k] += d[a] * d[b] / m.count;
    }
  }
  return m;
}

}  // namespace

SideCells::SideCells(const PointStore& store, double wanted, int threads)
    : width(std::max(wanted, std::ldexp(1.0, -kMortonBits)))
{
  const std::size_t n = store.size();
  AlignedVector<std::uint64_t> keys(n);
  AlignedVector<std::uint32_t> order;
  parallelFor((n + kTask - 1) / kTask, threads, 1, [&](std::size_t task, int) {
    for (std::size_t i = task * kTask; i < std::min(n, (task + 1) * kTask); ++i)
      keys[i] = codeOf(placeOf(store.position(i), width));
  });
  sortByKey(keys, order, threads);
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && keys[i] == keys[i - 1]) continue;
    begins.push_back(i);
    codes_.push_back(keys[i]);
  }
  begins.push_back(n);
  cells.resize(codes_.size());
  cell_of.resize(n);
  parallelFor(cells.size(), threads, 256, [&](std::size_t c, int) {
    cells[c] = momentsOf(store, order.data() + begins[c], order.data() + begins[c + 1]);
    for (std::size_t i = begins[c]; i < begins[c + 1]; ++i)
      cell_of[order[i]] = static_cast<std::uint32_t>(c);
  });
  index();
}

void
SideCells::index()
{
  std::size_t size = 2;
  while (size < 2 * codes_.size()) size *= 2;
  slots_.assign(size, kNone);
  for (std::uint32_t c = 0; c < codes_.size(); ++c) {
    std::size_t slot = hashOf(codes_[c]) & (size - 1);
    while (slots_[slot] != kNone) slot = (slot + 1) & (size - 1);
    slots_[slot] = c;
  }
}

std::uint32_t
SideCells::cellOf(std::uint64_t code) const
{
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashOf(code) & mask;
  while (slots_[slot] != kNone && codes_[slots_[slot]] != code) slot = (slot + 1) & mask;
  return slots_[slot];
}

std::uint32_t
SideCells::cellAt(const Vector3& place) const
{
  return cellOf(codeOf(placeOf(place, width)));
}

std::size_t
SideCells::cellsAbout(std::uint32_t cell, std::array<std::uint32_t, kWindow>& found) const
{
  const Place middle = placeOf(cells[cell].mean, width);
  std::array<std::array<std::uint64_t, 5>, 3> spread;
  std::array<std::array<bool, 5>, 3> inside;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::int64_t d = 0; d < 5; ++d) {
      const std::int64_t at = middle[a] + d - 2;
      inside[a][static_cast<std::size_t>(d)] = at >= 0 && at <= kLast;
      spread[a][static_cast<std::size_t>(d)] = spreadBits(static_cast<std::uint64_t>(at) & kLast)
                                               << (2 - a);
    }
  }
  std::size_t count = 0;
  for (std::size_t x = 0; x < 5; ++x) {
    for (std::size_t y = 0; y < 5; ++y) {
      for (std::size_t z = 0; z < 5; ++z) {
        if (!(inside[0][x] && inside[1][y] && inside[2][z])) continue;
        const std::uint32_t at = cellOf(spread[0][x] | spread[1][y] | spread[2][z]);
        if (at != kNone) found[count++] = at;
      }
    }
  }
  return count;
}

}  // namespace pcl_slim::detail

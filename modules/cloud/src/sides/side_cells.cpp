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
    const double cell = (p[a] + 0.5) / width;
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

/** The cubes of a brick whose place along an axis is in [first, last], a bit each. */
std::uint64_t
cubesWithin(std::size_t axis, std::int64_t first, std::int64_t last)
{
  // Bits of a code within a brick: x1 y1 z1 x0 y0 z0.
  constexpr std::uint64_t kHigh[3] = {0xffffffff00000000u, 0xffff0000ffff0000u,
                                      0xff00ff00ff00ff00u};
  constexpr std::uint64_t kLow[3] = {0xf0f0f0f0f0f0f0f0u, 0xccccccccccccccccu, 0xaaaaaaaaaaaaaaaau};
  std::uint64_t cubes = 0;
  for (std::int64_t at = std::max<std::int64_t>(first, 0); at <= std::min<std::int64_t>(last, 3);
       ++at)
    cubes |= (at & 2 ? kHigh[axis] : ~kHigh[axis]) & (at & 1 ? kLow[axis] : ~kLow[axis]);
  return cubes;
}

/** How many bits are set: sums of pairs, of fours, and of all bytes at once. */
std::uint32_t
countBits(std::uint64_t bits)
{
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<std::uint32_t>(bits * 0x0101010101010101u >> 56);
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
  std::vector<std::uint64_t> codes;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && keys[i] == keys[i - 1]) continue;
    begins.push_back(i);
    codes.push_back(keys[i]);
  }
  begins.push_back(n);
  cells.resize(codes.size());
  cell_of.resize(n);
  parallelFor(cells.size(), threads, 256, [&](std::size_t c, int) {
    cells[c] = momentsOf(store, order.data() + begins[c], order.data() + begins[c + 1]);
    for (std::size_t i = begins[c]; i < begins[c + 1]; ++i)
      cell_of[order[i]] = static_cast<std::uint32_t>(c);
  });
  index(codes);
}

void
SideCells::index(const std::vector<std::uint64_t>& codes)
{
  for (std::uint32_t c = 0; c < codes.size(); ++c) {
    if (c == 0 || codes[c] >> 6 != bricks_.back().code) bricks_.push_back({codes[c] >> 6, 0, c});
    bricks_.back().cubes |= std::uint64_t(1) << (codes[c] & 63);
  }
  std::size_t size = 2;
  while (size < 2 * bricks_.size()) size *= 2;
  slots_.assign(size, kNone);
  for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
    std::size_t slot = hashOf(bricks_[b].code) & (size - 1);
    while (slots_[slot] != kNone) slot = (slot + 1) & (size - 1);
    slots_[slot] = b;
  }
}

const SideCells::Brick&
SideCells::brickOf(std::uint64_t code) const
{
  static const Brick empty;
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hashOf(code) & mask;
  while (slots_[slot] != kNone && bricks_[slots_[slot]].code != code) slot = (slot + 1) & mask;
  return slots_[slot] == kNone ? empty : bricks_[slots_[slot]];
}

std::uint32_t
SideCells::cellAt(const Vector3& place) const
{
  const std::uint64_t code = codeOf(placeOf(place, width)), cube = std::uint64_t(1) << (code & 63);
  const Brick& brick = brickOf(code >> 6);
  return brick.cubes & cube ? brick.first + countBits(brick.cubes & (cube - 1)) : kNone;
}

std::size_t
SideCells::cellsAbout(std::uint32_t cell, std::array<std::uint32_t, kWindow>& found) const
{
  constexpr std::int64_t kReach = 2;
  const Place middle = placeOf(cells[cell].mean, width);
  Place first;                 // brick
  std::uint64_t within[3][2];  // cubes of the first and the next brick along each axis
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::max<std::int64_t>(middle[a] - kReach, 0) / 4;
    for (std::int64_t next = 0; next < 2; ++next) {
      const std::int64_t begin = 4 * (first[a] + next), from = middle[a] - begin;
      within[a][next] = begin > kLast ? 0 : cubesWithin(a, from - kReach, from + kReach);
    }
  }
  std::size_t count = 0;
  for (std::int64_t corner = 0; corner < 8; ++corner) {
    const std::int64_t x = corner >> 2, y = corner >> 1 & 1, z = corner & 1;
    std::uint64_t cubes = within[0][x] & within[1][y] & within[2][z];
    if (cubes == 0) continue;
    const Brick& brick = brickOf(codeOf({first[0] + x, first[1] + y, first[2] + z}));
    for (cubes &= brick.cubes; cubes != 0; cubes &= cubes - 1)
      found[count++] = brick.first + countBits(brick.cubes & ((cubes & (0 - cubes)) - 1));
  }
  return count;
}

}  // namespace pcl_slim::detail

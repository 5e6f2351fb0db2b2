// SPDX-License-Identifier: BSD-3-Clause
// The tree-like structure over a surface's levels (section 2 and Fig. 6 of the paper; theory.md,
// step "Links"), the grid that finds its links, and the sizes that a level of detail is chosen by.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/center_grid.h"
#include "pcl_slim/surface/detail/detail_sizes.h"

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
std::int64_t leastCode(const std::vector<Entry>& entries) {
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

  std::size_t of(const Entry& e) const {
    return static_cast<std::size_t>(((e.cell - base) >> shift) & mask);
  }
};

/** One stable counting pass. sorted and next are room to work in. */
void sortByDigit(const Digit& digit, std::vector<Entry>& entries, std::vector<Entry>& sorted,
                 std::vector<std::uint32_t>& next) {
  next.assign(static_cast<std::size_t>(digit.mask) + 2, 0);
  for (const Entry& e : entries) ++next[digit.of(e) + 1];
  for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
  for (const Entry& e : entries) sorted[next[digit.of(e)]++] = e;
  entries.swap(sorted);
}

/** Sorts by the digits in which codes differ, counted from the least coordinate of each axis. */
void sortByDigits(std::vector<Entry>& entries) {
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
    : inverse_(1.0 / std::max<double>(width, kNarrowest)) {
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

std::int64_t CenterGrid::cell(float local) const {
  return std::llround(std::clamp((local + 1.0) * inverse_, 0.0, kLastCell)) + 1;
}

std::vector<Entry> CenterGrid::sortedByCell(const SLIMSurface& surface,
                                            const std::vector<std::uint32_t>& surfels) const {
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

std::vector<Entry> CenterGrid::entries() const {
  std::vector<Entry> entries(size());
  for (std::size_t at = 0; at < size(); ++at) entries[at] = {codes_[at], members_[at]};
  return entries;
}

const CenterGrid::Ranges& CenterGrid::Walk::around(std::int64_t cell) {
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

void CenterGrid::findWithin(const Ranges& ranges, const float place[3], float limit_sq,
                            Near& near) const {
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

namespace {

/** \brief Surfels, the finest levels' first. */
std::vector<std::uint32_t> fromFinest(const SLIMSurface& surface) {
  std::vector<std::uint32_t> begin(257, 0), order(surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) ++begin[256u - surface.level[i]];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  for (std::size_t i = 0; i < surface.size(); ++i) {
    order[begin[255u - surface.level[i]]++] = static_cast<std::uint32_t>(i);
  }
  return order;
}

/** \brief Whether a parent's ball contains all that a child alone may cover: as neighbours overlap,
 * the inner part of its ball. */
bool holds(const SLIMSurface& surface, std::uint32_t parent, std::uint32_t child) {
  // Rays meet leaves and internal surfels elsewhere too, but never further from the nearest of
  // their kind.
  const float inner = surface.isLeaf(child) ? 0.5f : 0.7f;
  const float x = surface.cx[child] - surface.cx[parent],
              y = surface.cy[child] - surface.cy[parent];
  const float z = surface.cz[child] - surface.cz[parent];
  const float rest = DetailSizes::kCovers * surface.radius[parent] - inner * surface.radius[child];
  return rest > 0.0f && x * x + y * y + z * z <= rest * rest;
}

/** \brief Places all over the part of a surfel that rays meet, on its polynomial. */
template <typename Visit>
void visitPlaces(const SLIMSurface& surface, std::uint32_t surfel, const Visit& visit) {
  constexpr int kDirections = 8;
  const LocalFrame frame({surface.nx[surfel], surface.ny[surfel], surface.nz[surfel]});
  const Vector3 center{surface.cx[surfel], surface.cy[surfel], surface.cz[surfel]};
  const double radius = surface.radius[surfel];
  for (const double ring : {0.4, 0.8}) {
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::acos(-1.0) * k / kDirections;
      const double u = ring * std::cos(angle), v = ring * std::sin(angle);
      const double h = evaluateHeight(surface.degree[surfel], surface.coefficientsOf(surfel), u, v);
      if (u * u + v * v + h * h > DetailSizes::kCovers * DetailSizes::kCovers) continue;
      visit(along(along(along(center, radius * u, frame.u), radius * v, frame.v), radius * h,
                  frame.w));
    }
  }
}

/** \brief How far a surfel's surface reaches beyond its children's balls. */
float overhang(const SLIMSurface& surface, std::uint32_t surfel, std::uint32_t begin,
               std::uint32_t end) {
  double farthest = 0.0;
  visitPlaces(surface, surfel, [&](const Vector3& place) {
    double nearest = surface.radius[surfel];
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      const Vector3 center{surface.cx[child], surface.cy[child], surface.cz[child]};
      nearest = std::min(nearest, length(subtract(place, center)) - surface.radius[child]);
    }
    farthest = std::max(farthest, nearest);
  });
  return static_cast<float>(farthest);
}

}  // namespace

DetailSizes::DetailSizes(const SLIMSurface& surface)
    : own(surface.size(), 0.0f), parent(surface.size(), kNoParent) {
  const bool linked = surface.child_begin.size() == surface.size() + 1;
  const bool trimmed = !surface.trim_begin.empty();
  std::vector<bool> open(surface.size(), false);  // it or a descendant has a border
  for (const std::uint32_t i : fromFinest(surface)) {
    open[i] = trimmed && surface.trim_begin[i] < surface.trim_begin[i + 1];
    if (surface.isLeaf(i)) continue;
    const std::uint32_t begin = linked ? surface.child_begin[i] : 0;
    const std::uint32_t end = linked ? surface.child_begin[i + 1] : 0;
    float largest = 0.0f;
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      largest = std::max(largest, own[child]);
      open[i] = open[i] || open[child];
    }
    const float beyond = begin < end ? overhang(surface, i, begin, end) : 0.0f;
    const float wrong = 0.5f * std::max(kErrors * surface.error[i], kOverhangs * beyond);
    const float by_error = open[i] ? surface.radius[i] : wrong;
    own[i] = std::max(largest, std::min(surface.radius[i], by_error));
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint32_t child = surface.children[k];
      if (holds(surface, i, child)) parent[child] = std::min(parent[child], own[i]);
    }
  }
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kTask = 64;  ///< parents a thread takes at a time

/** The internal surfels of one level over those of the next. */
struct LevelPair {
  std::vector<std::uint32_t> parents, members;
  std::unique_ptr<CenterGrid> grid;               ///< of the members
  std::vector<CenterGrid::Entry> sorted_parents;  ///< in order of its cells

  void prepare(const SLIMSurface& s) {
    float widest = 0;
    for (const std::uint32_t i : parents) widest = std::max(widest, s.radius[i]);
    if (members.empty() || widest <= 0) return;
    grid = std::make_unique<CenterGrid>(s, members, std::max(widest, 1e-6f));
    sorted_parents = grid->sortedByCell(s, parents);
  }

  /** Members inside some of the parents' balls, ascending, each list in its parent's place. */
  void findChildren(const SLIMSurface& s, std::size_t begin, std::size_t end,
                    std::vector<std::vector<std::uint32_t>>& lists) const {
    CenterGrid::Walk walk(*grid);
    CenterGrid::Near near;
    for (std::size_t at = begin; at < end; ++at) {
      const auto& [cell, i] = sorted_parents[at];
      const float place[3] = {s.cx[i], s.cy[i], s.cz[i]};
      grid->findWithin(walk.around(cell), place, s.radius[i] * s.radius[i], near);
      std::vector<std::uint32_t>& children = lists[i];
      children.resize(near.count);
      for (std::size_t n = 0; n < near.count; ++n) children[n] = grid->memberAt(near.places[n]);
      std::sort(children.begin(), children.end());
    }
  }
};

/** Each level's internal surfels with the members of the next; the root ball is the parent of all.
 */
std::vector<LevelPair> levelPairs(const SLIMSurface& s, int threads) {
  std::vector<LevelPair> pairs(256);
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    if (!s.isLeaf(i)) pairs[s.level[i]].parents.push_back(i);
    if (s.level[i] > 0) pairs[s.level[i] - 1].members.push_back(i);
  }
  parallelFor(pairs.size(), threads, 1, [&](std::size_t k, int) { pairs[k].prepare(s); });
  return pairs;
}

/** The children of every surfel, in its place. */
std::vector<std::vector<std::uint32_t>> childLists(const SLIMSurface& s,
                                                   const std::vector<LevelPair>& pairs,
                                                   int threads) {
  struct Task {
    const LevelPair* pair;
    std::size_t begin;
  };
  std::vector<Task> tasks;
  for (const LevelPair& pair : pairs) {
    for (std::size_t at = 0; at < pair.sorted_parents.size(); at += kTask) {
      tasks.push_back({&pair, at});
    }
  }
  std::vector<std::vector<std::uint32_t>> lists(s.size());
  parallelFor(tasks.size(), threads, 1, [&](std::size_t t, int) {
    const auto [pair, begin] = tasks[t];
    pair->findChildren(s, begin, std::min(begin + kTask, pair->sorted_parents.size()), lists);
  });
  return lists;
}

/** Writes the lists one behind the other; what no list names becomes a root. */
void joinLists(const std::vector<std::vector<std::uint32_t>>& lists, SLIMSurface& s) {
  std::vector<char> linked(lists.size(), 0);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    s.children.insert(s.children.end(), lists[i].begin(), lists[i].end());
    s.child_begin[i + 1] = static_cast<std::uint32_t>(s.children.size());
    for (const std::uint32_t child : lists[i]) linked[child] = 1;
  }
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    if (!linked[i]) s.roots.push_back(i);
  }
}

/** A ball about the middle of the balls' box that contains them all. */
std::array<float, 4> enclosingBall(const SLIMSurface& s) {
  std::array<float, 4> ball{};
  const std::vector<float>* columns[3] = {&s.cx, &s.cy, &s.cz};
  for (std::size_t a = 0; a < 3; ++a) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (std::size_t i = 0; i < s.size(); ++i) {
      low = std::min(low, (*columns[a])[i] - s.radius[i]);
      high = std::max(high, (*columns[a])[i] + s.radius[i]);
    }
    ball[a] = 0.5f * (low + high);
  }
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double dx = s.cx[i] - ball[0], dy = s.cy[i] - ball[1], dz = s.cz[i] - ball[2];
    const double reach = std::sqrt(dx * dx + dy * dy + dz * dz) + s.radius[i];
    ball[3] = std::max(ball[3], static_cast<float>(reach * (1.0 + 1e-6)));
  }
  return ball;
}

}  // namespace

void SLIMSurface::buildLinks(int threads) {
  child_begin.assign(size() + 1, 0);
  children.clear();
  roots.clear();
  root_ball = {};
  if (empty()) return;
  joinLists(childLists(*this, levelPairs(*this, threads), threads), *this);
  root_ball = enclosingBall(*this);
}

}  // namespace pcl_slim

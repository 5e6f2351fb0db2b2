// SPDX-License-Identifier: BSD-3-Clause
// The tree-like structure over a surface's levels (section 2 and Fig. 6 of the paper; theory.md,
// step "Links").
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/surface/detail/center_grid.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kTask = 64;  ///< parents a thread takes at a time

/** The internal surfels of one level over those of the next. */
struct LevelPair {
  std::vector<std::uint32_t> parents, members;
  std::unique_ptr<CenterGrid> grid;               ///< of the members
  std::vector<CenterGrid::Entry> sorted_parents;  ///< in order of its cells

  void prepare(const SLIMSurface& s)
  {
    float widest = 0;
    for (const std::uint32_t i : parents) widest = std::max(widest, s.radius[i]);
    if (members.empty() || widest <= 0) return;
    grid = std::make_unique<CenterGrid>(s, members, std::max(widest, 1e-6f));
    sorted_parents = grid->sortedByCell(s, parents);
  }

  /** Members inside some of the parents' balls, ascending, each list in its parent's place. */
  void findChildren(const SLIMSurface& s, std::size_t begin, std::size_t end,
                    std::vector<std::vector<std::uint32_t>>& lists) const
  {
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

/** Each level's internal surfels with the members of the next; the root ball is the parent of all. */
std::vector<LevelPair>
levelPairs(const SLIMSurface& s, int threads)
{
  std::vector<LevelPair> pairs(256);
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    if (!s.isLeaf(i)) pairs[s.level[i]].parents.push_back(i);
    if (s.level[i] > 0) pairs[s.level[i] - 1].members.push_back(i);
  }
  parallelFor(pairs.size(), threads, 1, [&](std::size_t k, int) { pairs[k].prepare(s); });
  return pairs;
}

/** The children of every surfel, in its place. */
std::vector<std::vector<std::uint32_t>>
childLists(const SLIMSurface& s, const std::vector<LevelPair>& pairs, int threads)
{
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
void
joinLists(const std::vector<std::vector<std::uint32_t>>& lists, SLIMSurface& s)
{
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
std::array<float, 4>
enclosingBall(const SLIMSurface& s)
{
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

void
SLIMSurface::buildLinks(int threads)
{
  child_begin.assign(size() + 1, 0);
  children.clear();
  roots.clear();
  root_ball = {};
  if (empty()) return;
  joinLists(childLists(*this, levelPairs(*this, threads), threads), *this);
  root_ball = enclosingBall(*this);
}

}  // namespace pcl_slim

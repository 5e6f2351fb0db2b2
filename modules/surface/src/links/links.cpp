// SPDX-License-Identifier: BSD-3-Clause
// The tree-like structure over a surface's levels (section 2, Fig. 6).
#include <algorithm>
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

}  // namespace

void
SLIMSurface::buildLinks(int threads)
{
  child_begin.assign(size() + 1, 0);
  children.clear();
  roots.clear();
  root_ball = {};
  if (empty()) return;

  std::vector<LevelPair> pairs(256);
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (!isLeaf(i)) pairs[level[i]].parents.push_back(i);
    if (level[i] > 0) pairs[level[i] - 1].members.push_back(i);
  }
  parallelFor(pairs.size(), threads, 1, [&](std::size_t k, int) { pairs[k].prepare(*this); });
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
  std::vector<std::vector<std::uint32_t>> lists(size());
  parallelFor(tasks.size(), threads, 1, [&](std::size_t t, int) {
    const auto [pair, begin] = tasks[t];
    pair->findChildren(*this, begin, std::min(begin + kTask, pair->sorted_parents.size()), lists);
  });
  std::vector<char> linked(size(), 0);
  for (std::uint32_t i = 0; i < size(); ++i) {
    child_begin[i + 1] = static_cast<std::uint32_t>(lists[i].size());
    children.insert(children.end(), lists[i].begin(), lists[i].end());
    for (const std::uint32_t child : lists[i]) linked[child] = 1;
  }
  for (std::size_t i = 0; i < size(); ++i) child_begin[i + 1] += child_begin[i];
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (!linked[i]) roots.push_back(i);
  }

  float low[3], high[3];
  const std::vector<float>* columns[3] = {&cx, &cy, &cz};
  for (int a = 0; a < 3; ++a) {
    low[a] = std::numeric_limits<float>::max();
    high[a] = -low[a];
    for (std::size_t i = 0; i < size(); ++i) {
      low[a] = std::min(low[a], (*columns[a])[i] - radius[i]);
      high[a] = std::max(high[a], (*columns[a])[i] + radius[i]);
    }
    root_ball[a] = 0.5f * (low[a] + high[a]);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const double dx = cx[i] - root_ball[0], dy = cy[i] - root_ball[1], dz = cz[i] - root_ball[2];
    const double reach = std::sqrt(dx * dx + dy * dy + dz * dz) + radius[i];
    root_ball[3] = std::max(root_ball[3], static_cast<float>(reach * (1.0 + 1e-6)));
  }
}

}  // namespace pcl_slim

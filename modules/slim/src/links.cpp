// SPDX-License-Identifier: BSD-3-Clause
// The tree-like structure over a surface's levels (section 2, Fig. 6).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "center_grid.h"

namespace pcl_slim {

void
SLIMSurface::buildLinks()
{
  child_begin.assign(size() + 1, 0);
  children.clear();
  roots.clear();
  root_ball = {};
  if (empty()) return;

  std::vector<std::vector<std::uint32_t>> members(257), parents(256);
  for (std::uint32_t i = 0; i < size(); ++i) {
    members[level[i]].push_back(i);
    if (!isLeaf(i)) parents[level[i]].push_back(i);
  }

  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;  // parent, child
  std::vector<char> linked(size(), 0);
  for (int k = 0; k < 256; ++k) {
    float widest = 0;
    for (const std::uint32_t i : parents[k]) widest = std::max(widest, radius[i]);
    if (members[k + 1].empty() || widest <= 0) continue;
    const CenterGrid grid(*this, members[k + 1], std::max(widest, 1e-6f));
    CenterGrid::Walk walk(grid);
    CenterGrid::Near near;
    for (const auto& [cell, parent] : grid.sortedByCell(*this, parents[k])) {
      const float place[3] = {cx[parent], cy[parent], cz[parent]};
      grid.findWithin(walk.around(cell), place, radius[parent] * radius[parent], near);
      for (std::size_t n = 0; n < near.count; ++n) {
        const std::uint32_t child = grid.memberAt(near.places[n]);
        links.emplace_back(parent, child);
        linked[child] = 1;
      }
    }
  }
  std::sort(links.begin(), links.end());
  children.reserve(links.size());
  for (const auto& [parent, child] : links) {
    ++child_begin[parent + 1];
    children.push_back(child);
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

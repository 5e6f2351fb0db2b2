// SPDX-License-Identifier: BSD-3-Clause
#include "borders/open_summary.h"

#include <algorithm>
#include <cstdio>

namespace pcl_slim::borders {

OpenSummary::Sum& OpenSummary::group(const std::string& method, const std::string& name) {
  const auto [found, fresh] = sums_.emplace(std::pair(method, name), Sum());
  if (fresh) order_.emplace_back(method, name);
  return found->second;
}

void OpenSummary::add(const std::string& method, const std::string& scene, double noise,
                      const RowOutcome& row) {
  char level[32];
  std::snprintf(level, sizeof level, "noise %g", noise);
  for (const std::string& name :
       {scene.substr(0, scene.find('-')), std::string(level), std::string("all")}) {
    Sum& sum = group(method, name);
    ++sum.rows;
    sum.meshes += row.mesh ? 1 : 0;
    sum.pictures += row.picture ? 1 : 0;
    sum.both += row.mesh && row.picture ? 1 : 0;
    sum.loops += row.loops ? 1 : 0;
    sum.to_keep += row.to_keep;
    sum.kept += row.kept;
    sum.open += row.open;
    sum.beyond = std::max(sum.beyond, row.beyond);
    sum.missing = std::max(sum.missing, row.missing);
    sum.seen_beyond = std::max(sum.seen_beyond, row.seen_beyond);
    sum.unseen = std::max(sum.unseen, row.unseen);
    sum.has_picture = row.has_picture;
  }
}

void OpenSummary::print() const {
  std::printf(
      "\n| method | scenes | rows | meshes good | loops right | holes kept | most beyond, missing "
      "| pictures good | holes open | most beyond, missing | both |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<std::pair<std::string, std::string>> order = order_;
  // Kinds first, then noise, all rows last: what a row is added to comes in another order.
  const auto rank = [](const std::string& name) {
    return name == "all" ? 2 : name.compare(0, 6, "noise ") == 0 ? 1 : 0;
  };
  std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : rank(a.second) < rank(b.second);
  });
  for (const auto& key : order) {
    const Sum& s = sums_.at(key);
    std::printf("| %s | %s | %zu | %zu | %zu | %zu of %zu | %.2f, %.2f |", key.first.c_str(),
                key.second.c_str(), s.rows, s.meshes, s.loops, s.kept, s.to_keep, s.beyond,
                s.missing);
    if (s.has_picture) {
      std::printf(" %zu | %zu of %zu | %.2f, %.2f | %zu |\n", s.pictures, s.open, s.to_keep,
                  s.seen_beyond, s.unseen, s.both);
    } else {
      std::printf(" | | | |\n");
    }
  }
}

}  // namespace pcl_slim::borders

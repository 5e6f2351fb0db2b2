// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "orient.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/detail/center_grid.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

constexpr double kMargin = 1.0001;  ///< more is sought than needed, for rounding; dropped after
constexpr std::size_t kTask = 512;  ///< leaves a thread takes at a time; no result depends on it

/** The leaves of one level, and all that look for neighbours among them: these leaves and finer
 * ones, in order of the grid's cells. */
struct LevelLeaves {
  int level = 0;
  float widest = 0;  ///< of their radii
  std::unique_ptr<CenterGrid> grid;
  std::vector<float> radii;  ///< in its order
  std::vector<CenterGrid::Entry> seekers;
};

LevelLeaves makeLevel(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves, int level,
                      const OrientConstants& constants) {
  std::vector<std::uint32_t> members, seekers;
  LevelLeaves result;
  float& widest = result.widest;
  for (const std::uint32_t i : leaves) {
    if (s.level[i] != level) continue;
    members.push_back(i);
    widest = std::max(widest, s.radius[i]);
  }
  for (const std::uint32_t i : leaves) {
    if (s.level[i] > level) seekers.push_back(i);
  }
  result.level = level;
  const auto twice_reach = static_cast<float>(2.0 * constants.reach);
  result.grid = std::make_unique<CenterGrid>(s, members, twice_reach * widest);
  result.radii.resize(members.size());
  for (std::size_t at = 0; at < members.size(); ++at) {
    result.radii[at] = s.radius[result.grid->memberAt(at)];
  }
  const auto before = [](const CenterGrid::Entry& a, const CenterGrid::Entry& b) {
    return a.cell < b.cell;
  };
  result.seekers = result.grid->entries();
  const auto finer = result.grid->sortedByCell(s, seekers);
  const auto own = static_cast<std::ptrdiff_t>(result.seekers.size());
  result.seekers.insert(result.seekers.end(), finer.begin(), finer.end());
  std::inplace_merge(result.seekers.begin(), result.seekers.begin() + own, result.seekers.end(),
                     before);
  return result;
}

using Neighbor = std::pair<float, std::uint32_t>;  ///< squared distance, surfel

/** The nearest few of some neighbours. */
class NearestFew {
 public:
  explicit NearestFew(std::size_t most) : few_(most) {}

  void clear() { count_ = 0; }

  void offer(const Neighbor& neighbor) {
    if (count_ == few_.size() && !(neighbor < few_[count_ - 1])) return;
    std::size_t place = count_ < few_.size() ? count_++ : count_ - 1;
    for (; place > 0 && neighbor < few_[place - 1]; --place) few_[place] = few_[place - 1];
    few_[place] = neighbor;
  }

  const Neighbor* begin() const { return few_.data(); }
  const Neighbor* end() const { return few_.data() + count_; }

 private:
  std::vector<Neighbor> few_;
  std::size_t count_ = 0;
};

/** Finds a seeker's overlapping leaves on one level, those of the seeker's own only once. */
class NeighborFinder {
 public:
  NeighborFinder(const SLIMSurface& surface, const LevelLeaves& level,
                 const OrientConstants& constants)
      : surface_(surface),
        level_(level),
        reach_(constants.reach),
        walk_(*level.grid),
        few_(constants.neighbors) {}

  const NearestFew& nearest(const CenterGrid::Entry& seeker) {
    const auto [cell, i] = seeker;
    const float radius = surface_.radius[i];
    const float place[3] = {surface_.cx[i], surface_.cy[i], surface_.cz[i]};
    const double farthest = kMargin * reach_ * (radius + level_.widest);
    level_.grid->findWithin(walk_.around(cell), place, static_cast<float>(farthest * farthest),
                            near_);
    const bool same_level = surface_.level[i] == level_.level;
    const std::uint32_t below = same_level ? i : static_cast<std::uint32_t>(surface_.size());
    few_.clear();
    for (std::size_t k = 0; k < near_.count; ++k) {
      const std::uint32_t j = level_.grid->memberAt(near_.places[k]);
      const double reach = reach_ * (radius + level_.radii[near_.places[k]]);
      const float distance_sq = near_.distances_sq[k];
      if (j < below && distance_sq < reach * reach) few_.offer({distance_sq, j});
    }
    return few_;
  }

 private:
  const SLIMSurface& surface_;
  const LevelLeaves& level_;
  double reach_;
  CenterGrid::Walk walk_;
  CenterGrid::Near near_;
  NearestFew few_;
};

}  // namespace

std::vector<SidePatch> patchesOf(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves) {
  std::vector<SidePatch> patches(leaves.size());
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    const std::uint32_t i = leaves[k];
    const Vector3 normal{s.nx[i], s.ny[i], s.nz[i]};
    const double radius = s.radius[i];
    const double height = radius * s.coefficientsOf(i)[0];  // of the polynomial over the centre
    patches[k] = {along({s.cx[i], s.cy[i], s.cz[i]}, height, normal), normal, radius * radius};
  }
  return patches;
}

std::vector<SignedEdge> overlapGraph(const SLIMSurface& s, const std::vector<std::uint32_t>& leaves,
                                     const std::vector<SidePatch>& patches, int threads,
                                     const OrientConstants& constants) {
  std::vector<std::uint32_t> place(s.size());
  for (std::size_t k = 0; k < leaves.size(); ++k) place[leaves[k]] = static_cast<std::uint32_t>(k);
  std::array<bool, 256> seen{};
  for (const std::uint32_t i : leaves) seen[s.level[i]] = true;
  std::vector<int> numbers;
  for (int k = 0; k < 256; ++k) {
    if (seen[static_cast<std::size_t>(k)]) numbers.push_back(k);
  }
  // Leaves of one level are alike in size, so each level has one grid.
  std::vector<LevelLeaves> levels(numbers.size());
  parallelFor(levels.size(), threads, 1,
              [&](std::size_t k, int) { levels[k] = makeLevel(s, leaves, numbers[k], constants); });
  struct Task {
    std::size_t level, begin;
  };
  std::vector<Task> tasks;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    for (std::size_t at = 0; at < levels[k].seekers.size(); at += kTask) tasks.push_back({k, at});
  }
  std::vector<std::vector<SignedEdge>> parts(tasks.size());
  parallelFor(tasks.size(), threads, 1, [&](std::size_t t, int) {
    const LevelLeaves& level = levels[tasks[t].level];
    const std::size_t end = std::min(tasks[t].begin + kTask, level.seekers.size());
    parts[t].reserve(constants.neighbors * (end - tasks[t].begin));
    NeighborFinder finder(s, level, constants);
    for (std::size_t at = tasks[t].begin; at < end; ++at) {
      const std::uint32_t own = place[level.seekers[at].surfel];
      for (const auto& [distance_sq, j] : finder.nearest(level.seekers[at]))
        parts[t].push_back(edgeBetween(patches, place[j], own));
    }
  });
  std::vector<SignedEdge> edges;
  for (auto& part : parts) {
    edges.insert(edges.end(), part.begin(), part.end());
    std::vector<SignedEdge>().swap(part);
  }
  return edges;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "octree/octree_forest.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "octree/octree_runs.h"

namespace pcl_slim::detail {

namespace {

constexpr double kColorUnit = 1e-4;     ///< CIELAB / 100, as the tolerances are scaled
constexpr double kNormalWeight = 0.05;  ///< of normal variance beside colour variance
constexpr double kBendWeight = 0.5;     ///< of its square: cells that bend round leave no outline

/** D without its power of the edge. Points and area count alike, as pictures show area however
 * densely it was scanned; the powers of deviation and edge are those whose pictures come closest to
 * all points (benchmarks/README.md). */
double
costOf(double points, double deviation)
{
  return std::sqrt(points * deviation) * deviation;
}

class ForestBuilder {
 public:
  ForestBuilder(const OctreeCloud& cloud, const SplitRule& rule, const PointWindow& window,
                std::vector<OctreeNode>& nodes, OctreeForest& forest)
      : keys_{cloud.keys()},
        rule_(rule),
        window_(window),
        nodes_(nodes),
        forest_(forest),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
    nodes_.clear();
    for (int shift = 0; shift <= OctreeCloud::kBits; ++shift) {
      const double edge = cloud.edge(shift);
      width_[static_cast<std::size_t>(shift)] = edge * std::sqrt(std::sqrt(edge));
    }
  }

  void root(std::size_t begin, std::size_t end, int shift)
  {
    grow(begin, end, shift, nullptr);
    forest_.roots.push_back(static_cast<std::uint32_t>(nodes_.size() - 1));
  }

  void finish() { forest_.nodes.assign(nodes_.begin(), nodes_.end()); }

 private:
  /** Adds the nodes of one cell's points; parent: receives their sums too, if not null. */
  void grow(std::size_t begin, std::size_t end, int shift, CellSums* parent)
  {
    const std::size_t first = nodes_.size(), n = end - begin;
    OctreeNode node{
        static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), 1, 0, 0, 0, shift};
    if (n == 1) {
      if (parent) parent->add(window_, begin, end);
      nodes_.push_back(node);
      return;
    }
    const int children = dividing(begin, end);
    const bool whole = children < least_shift_;
    const bool direct = whole || n <= kDirect;
    CellSums sums = direct ? sumsOf(window_, begin, end) : CellSums();
    if (!whole) {
      // What all points share is the cell: an ancestor of the same points costs no less.
      node.shift = std::min(shift, children + 1);
      for (std::size_t at = begin; at < end;) {
        const std::size_t next = keys_.runEnd(at, end, children);
        grow(at, next, children, direct ? nullptr : &sums);
        at = next;
      }
    }
    if (parent) parent->add(sums);
    const double slack = 1.0 + rule_.noise_z / std::sqrt(sums.count - 1.0);
    const double color = std::max(0.0, sums.colorVariance() - rule_.noise.color * slack);
    const double normal = std::max(0.0, variance(sums) - rule_.noise.normal * slack);
    const double shape = (kNormalWeight + kBendWeight * normal) * normal;
    const double spread = std::sqrt(kColorUnit * color + shape);
    if (n >= kSpacingPoints) node.spacing = static_cast<float>(sums.spacing());
    node.cost = costOf(sums.count, spread) * width_[static_cast<std::size_t>(node.shift)];
    node.error = sums.count * std::sqrt(color);
    node.size = static_cast<std::uint32_t>(nodes_.size() - first + 1);
    nodes_.push_back(node);
  }

  /** Level at which a cell's points fall apart; below least_shift_: not at all. */
  int dividing(std::size_t begin, std::size_t end) const
  {
    return end - begin < rule_.min_points ? -1 : keys_.dividingShift(begin, end);
  }

  double variance(const CellSums& sums) const
  {
    return rule_.oriented ? sums.orientedVariance() : sums.unorientedVariance();
  }

  static constexpr std::size_t kDirect = 32;  ///< points quicker summed again than from children

  RunKeys keys_;
  const SplitRule& rule_;
  const PointWindow& window_;
  std::vector<OctreeNode>& nodes_;
  OctreeForest& forest_;
  int least_shift_;
  std::array<double, OctreeCloud::kBits + 1> width_;  ///< edge^(5/4) by level
};

}  // namespace

double
OctreeForest::childrenBest(std::size_t i) const
{
  double sum = 0;
  for (std::size_t child = i - 1, left = nodes[i].size - 1; left > 0;) {
    sum += best[child];
    const std::size_t size = nodes[child].size;
    left -= size;
    child -= size;
  }
  return sum;
}

void
OctreeForest::solve(double lambda)
{
  best.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double own = nodes[i].cost + lambda;
    best[i] = nodes[i].size == 1 ? own : std::min(own, childrenBest(i));
  }
  cells = 0;
  error = 0;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (!whole(i, lambda)) continue;
    ++cells;
    error += nodes[i].error;
    i -= nodes[i].size - 1;
  }
}

void
OctreeForest::extract(double lambda, std::size_t i, float spacing,
                      std::vector<OctreeCell>& out) const
{
  const OctreeNode& node = nodes[i];
  if (node.spacing > 0) spacing = node.spacing;
  if (whole(i, lambda)) {
    out.push_back({node.begin, node.end, spacing, node.shift});
    return;
  }
  std::uint32_t children[8];
  int count = 0;
  for (std::size_t child = i - 1, left = node.size - 1; left > 0;) {
    children[count++] = static_cast<std::uint32_t>(child);
    const std::size_t size = nodes[child].size;
    left -= size;
    child -= size;
  }
  while (count > 0) extract(lambda, children[--count], spacing, out);
}

std::vector<OctreeForest>
growForests(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule, int growth,
            int threads)
{
  std::vector<OctreeForest> forests(numRootSlices(cloud));
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  std::vector<std::vector<OctreeNode>> nodes(windows.size());
  forEachRootSlice(
      cloud, growth, threads,
      [&](std::size_t slice, std::size_t thread, std::size_t first, std::size_t last) {
        PointWindow& window = windows[thread];
        const std::size_t begin = cloud.root(first).begin, end = cloud.root(last).begin;
        window.load(cloud, source, begin, end);
        ForestBuilder builder(cloud, rule, window, nodes[thread], forests[slice]);
        for (std::size_t r = first; r < last;) {
          const std::size_t group = r;
          const std::uint64_t key = cloud.root(r).key >> 3 * growth;
          while (r < last && cloud.root(r).key >> 3 * growth == key) ++r;
          builder.root(cloud.root(group).begin, cloud.root(r).begin, cloud.depth() + growth);
        }
        builder.finish();
      });
  return forests;
}

}  // namespace pcl_slim::detail

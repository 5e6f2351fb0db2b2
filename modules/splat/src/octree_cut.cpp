// SPDX-License-Identifier: BSD-3-Clause
#include "octree_cut.h"

#include <algorithm>
#include <cmath>

#include "octree_runs.h"

namespace pcl_slim {

namespace {

constexpr double kColorUnit = 1e-4;     ///< CIELAB / 100, as the tolerances are scaled
constexpr double kNormalWeight = 0.05;  ///< of normal variance beside colour variance
constexpr double kBendWeight = 0.5;     ///< of its square: cells that bend round leave no outline
constexpr double kCountSlack = 0.005;   ///< a solved count may fall this far short
constexpr double kRootShare = 0.25;     ///< roots as a share of the cells allowed
constexpr int kMostSteps = 60;
constexpr double kWidestLambda = 1e-14;  ///< smallest lambda as a share of the largest

/** A cell of the whole tree. Children stand before their parent. */
struct Node {
  std::uint32_t begin, end;
  std::uint32_t size;  ///< nodes of its subtree, itself included
  float spacing;       ///< of its own points; 0: too few
  double cost;         ///< D
  double error;        ///< points times Delta E
  std::int32_t shift;
};

/** The trees of one slice's roots, and the best cut for one lambda. */
struct Forest {
  std::vector<Node> nodes;
  std::vector<double> best;          ///< least D + lambda * cells of each subtree
  std::vector<std::uint32_t> roots;  ///< places of roots
  std::uint64_t cells = 0;           ///< of the best cut
  double error = 0;

  double childrenBest(std::size_t i) const
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

  bool whole(std::size_t i, double lambda) const { return best[i] >= nodes[i].cost + lambda; }

  void solve(double lambda)
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

  void extract(double lambda, std::size_t i, float spacing, std::vector<OctreeCell>& out) const
  {
    const Node& node = nodes[i];
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
};

/** D. Points and area count alike, as pictures show area however densely it was scanned; the
 * powers of deviation and edge are those whose pictures come closest to all points (docs/splats.md). */
double
costOf(double points, double deviation, double edge)
{
  return std::sqrt(points * deviation) * deviation * edge * std::sqrt(std::sqrt(edge));
}

class ForestBuilder {
 public:
  ForestBuilder(const OctreeCloud& cloud, const SplitRule& rule, PointWindow& window,
                Forest& forest)
      : cloud_(cloud),
        rule_(rule),
        window_(window),
        forest_(forest),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
  }

  void root(std::size_t begin, std::size_t end, int shift)
  {
    grow(begin, end, shift, keysOf(cloud_));
    forest_.roots.push_back(static_cast<std::uint32_t>(forest_.nodes.size() - 1));
  }

 private:
  CellSums grow(std::size_t begin, std::size_t end, int shift, RunKeys keys)
  {
    const std::size_t first = forest_.nodes.size(), n = end - begin;
    int children = -1;
    if (n > 1 && n >= rule_.min_points) {
      if (keys.keys) children = keys.dividingShift(begin, end);
      if (children < keys.lowest && keys.lowest > least_shift_) {
        keys = refine(cloud_, window_, begin, end, keys_);
        children = keys.dividingShift(begin, end);
      }
    }
    CellSums sums;
    if (children < least_shift_) {
      sums = sumsOf(window_, begin, end);
    } else {
      // What all points share is the cell: an ancestor of the same points costs no less.
      shift = std::min(shift, children + 1);
      for (std::size_t at = begin; at < end;) {
        const std::size_t next = keys.runEnd(at, end, children);
        sums.add(grow(at, next, children, keys));
        at = next;
      }
    }
    const double slack = 1.0 + rule_.noise_z / std::sqrt(std::max(1.0, sums.count - 1.0));
    const double color =
        n > 1 ? std::max(0.0, sums.colorVariance() - rule_.noise.color * slack) : 0.0;
    const double normal = n > 1 ? std::max(0.0, variance(sums) - rule_.noise.normal * slack) : 0.0;
    const double shape = (kNormalWeight + kBendWeight * normal) * normal;
    const double spread = std::sqrt(kColorUnit * color + shape);
    forest_.nodes.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
                             static_cast<std::uint32_t>(forest_.nodes.size() - first + 1),
                             n >= kSpacingPoints ? static_cast<float>(sums.spacing()) : 0.0f,
                             costOf(sums.count, spread, cloud_.edge(shift)),
                             sums.count * std::sqrt(color), shift});
    return sums;
  }

  double variance(const CellSums& sums) const
  {
    return rule_.oriented ? sums.orientedVariance() : sums.unorientedVariance();
  }

  const OctreeCloud& cloud_;
  const SplitRule& rule_;
  PointWindow& window_;
  Forest& forest_;
  int least_shift_;
  AlignedVector<std::uint64_t> keys_;  ///< of one run that the cloud's keys do not tell apart
};

/** Finds lambda. */
class CutSolver {
 public:
  CutSolver(OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
            const CutBudget& budget, int threads)
      : cloud_(cloud), budget_(budget), threads_(threads), forests_(numRootSlices(cloud))
  {
    const double most = std::max(1.0, kRootShare * 1.5 * static_cast<double>(budget.max_cells));
    int growth = 0;
    while (budget.max_cells > 0 &&
           cloud.depth() +
               growth<OctreeCloud::kBits&& static_cast<double>(cloud.countCells(growth))> most) {
      ++growth;
    }
    plant(cloud, source, rule, growth);
  }

  OctreeCut run()
  {
    double high = 0;
    for (const Forest& forest : forests_) {
      for (const std::uint32_t root : forest.roots) high += forest.nodes[root].cost;
    }
    double lambda = 0;
    solve(lambda);
    if (!fits()) lambda = search(high);
    OctreeCut cut;
    solve(lambda);
    cut.error = error_ / static_cast<double>(cloud_.size());
    std::vector<std::vector<OctreeCell>> parts(forests_.size());
    parallelFor(forests_.size(), threads_, 1, [&](std::size_t f, int) {
      for (const std::uint32_t root : forests_[f].roots) {
        forests_[f].extract(lambda, root, 0.0f, parts[f]);
      }
    });
    for (const Forest& forest : forests_) cut.nodes += forest.nodes.size();
    cut.cells = joined(parts);
    return cut;
  }

 private:
  /** The trees above all points, whose order becomes the full one. */
  void plant(OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule, int growth)
  {
    std::vector<PointWindow> windows(static_cast<std::size_t>(threads_));
    forEachRootSlice(
        cloud, growth, threads_,
        [&](std::size_t slice, std::size_t thread, std::size_t first, std::size_t last) {
          PointWindow& window = windows[thread];
          const std::size_t begin = cloud.root(first).begin, end = cloud.root(last).begin;
          window.load(cloud, source, begin, end);
          ForestBuilder builder(cloud, rule, window, forests_[slice]);
          for (std::size_t r = first; r < last;) {
            const std::size_t group = r;
            const std::uint64_t key = cloud.root(r).key >> 3 * growth;
            while (r < last && cloud.root(r).key >> 3 * growth == key) ++r;
            builder.root(cloud.root(group).begin, cloud.root(r).begin, cloud.depth() + growth);
          }
          for (std::size_t i = begin; i < end; ++i) cloud.setOrder(i, window.order(i));
        });
  }

  void solve(double lambda)
  {
    parallelFor(forests_.size(), threads_, 1,
                [&](std::size_t f, int) { forests_[f].solve(lambda); });
    cells_ = 0;
    error_ = 0;
    for (const Forest& forest : forests_) {
      cells_ += forest.cells;
      error_ += forest.error;
    }
  }

  /** Whether the finest cut is what is asked for already. */
  bool fits() const
  {
    if (budget_.max_cells > 0) return cells_ <= budget_.max_cells;
    return budget_.target_error <= 0 || meanError() >= budget_.target_error;
  }

  double meanError() const { return error_ / static_cast<double>(cloud_.size()); }

  /** Halves log lambda between a cut too fine and one coarse enough (max_cells), or one fine
   * enough and one too coarse (target_error). \return a lambda that keeps the promise. */
  double search(double highest)
  {
    const bool by_count = budget_.max_cells > 0;
    double low = highest * kWidestLambda, high = highest * 2.0;
    for (int step = 0; step < kMostSteps && high / low > 1.0 + 1e-9; ++step) {
      const double middle = std::sqrt(low * high);
      solve(middle);
      const double limit = by_count ? static_cast<double>(budget_.max_cells) : budget_.target_error;
      const double value = by_count ? static_cast<double>(cells_) : meanError();
      const bool kept = value <= limit;
      (kept == by_count ? high : low) = middle;
      if (kept && value >= limit * (1.0 - kCountSlack)) return middle;
    }
    return by_count ? high : low;
  }

  const OctreeCloud& cloud_;
  const CutBudget& budget_;
  int threads_;
  std::vector<Forest> forests_;
  std::uint64_t cells_ = 0;
  double error_ = 0;
};

}  // namespace

OctreeCut
cutOptimally(OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
             const CutBudget& budget, int threads)
{
  return CutSolver(cloud, source, rule, budget, threads).run();
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The best cut of the whole octree for a budget: docs/color_octree_splat_sampler.md, "Parameters".
#include "octree/octree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_slim::detail {

namespace {

/** A cell of the whole tree. Children precede their parent. */
struct OctreeNode {
  std::uint32_t begin, end;
  std::uint32_t size;  ///< nodes of its subtree, itself included
  float spacing;       ///< of its own points; 0: too few
  double cost;         ///< D
  double error;        ///< points times Delta E
  std::int32_t shift;
};

/** The trees of one slice's roots, and the best cut for one lambda. */
struct OctreeForest {
  std::vector<OctreeNode> nodes;
  std::vector<double> best;          ///< least D + lambda * cells of each subtree
  std::vector<std::uint32_t> roots;  ///< places of roots
  std::uint64_t cells = 0;           ///< of the best cut
  double error = 0;

  /** Finds the best cut. O(nodes). */
  void solve(double lambda);
  /** Its cells below a node, in order. spacing: around the node, where its points are too few. */
  void extract(double lambda, std::size_t node, float spacing, std::vector<OctreeCell>& out) const;

 private:
  double childrenBest(std::size_t i) const;
  bool whole(std::size_t i, double lambda) const { return best[i] >= nodes[i].cost + lambda; }
};

constexpr double kColorUnit = 1e-4;     ///< CIELAB / 100, as the tolerances are scaled
constexpr double kNormalWeight = 0.05;  ///< of normal variance relative to colour variance
constexpr double kBendWeight = 0.5;     ///< of its square: cells that bend round leave no outline

/** D without its power of the edge. Points and area count alike, as pictures show area however
 * densely it was scanned; the powers of deviation and edge are those whose pictures come closest to
 * all points (benchmarks/README.md). */
double costOf(double points, double deviation) {
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
        least_shift_(std::max(0, cloud.depth() - rule.max_depth)) {
    nodes_.clear();
    for (int shift = 0; shift <= OctreeCloud::kBits; ++shift) {
      const double edge = cloud.edge(shift);
      width_[static_cast<std::size_t>(shift)] = edge * std::sqrt(std::sqrt(edge));
    }
  }

  void root(std::size_t begin, std::size_t end, int shift) {
    grow(begin, end, shift, nullptr);
    forest_.roots.push_back(static_cast<std::uint32_t>(nodes_.size() - 1));
  }

  void finish() { forest_.nodes.assign(nodes_.begin(), nodes_.end()); }

 private:
  /** Adds the nodes of one cell's points; parent: receives their sums too, if not null. */
  void grow(std::size_t begin, std::size_t end, int shift, CellSums* parent) {
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
  int dividing(std::size_t begin, std::size_t end) const {
    return end - begin < rule_.min_points ? -1 : keys_.dividingShift(begin, end);
  }

  double variance(const CellSums& sums) const {
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

double OctreeForest::childrenBest(std::size_t i) const {
  double sum = 0;
  for (std::size_t child = i - 1, left = nodes[i].size - 1; left > 0;) {
    sum += best[child];
    const std::size_t size = nodes[child].size;
    left -= size;
    child -= size;
  }
  return sum;
}

void OctreeForest::solve(double lambda) {
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

void OctreeForest::extract(double lambda, std::size_t i, float spacing,
                           std::vector<OctreeCell>& out) const {
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

/** Grows the trees above all points, slice by slice, from cells 2^growth roots wide. */
std::vector<OctreeForest> growForests(const OctreeCloud& cloud, const OctreeSource& source,
                                      const SplitRule& rule, int growth, int threads) {
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

constexpr double kCountSlack = 0.005;  ///< a solved count may fall this far short
constexpr double kRootShare = 0.25;    ///< roots as a share of the cells allowed
constexpr int kMostSteps = 60;
constexpr double kWidestLambda = 1e-14;  ///< smallest lambda as a share of the largest

/** An interval of lambda that closes on a root. Counts and errors are near powers of lambda, so the
 * false position of logarithms is soon close; where it stalls on one side, halving takes over. */
class Bracket {
 public:
  Bracket(double low, double high) : low_(std::log(low)), high_(std::log(high)) {}

  bool closed() const { return high_ - low_ < 1e-9; }
  double low() const { return std::exp(low_); }
  double high() const { return std::exp(high_); }

  /** Where to look. */
  double next(int step) {
    double share = 0.5;
    const bool known = low_value_ != 0 && high_value_ != 0;
    if (known && step % 3 != 2) {
      share = std::clamp(low_value_ / (low_value_ - high_value_), 0.02, 0.98);
    }
    at_ = low_ + share * (high_ - low_);
    return std::exp(at_);
  }

  /** What was there: its logarithm over the limit, and whether that belongs to the upper end. */
  void narrow(bool upper, double value) {
    (upper ? high_ : low_) = at_;
    (upper ? high_value_ : low_value_) = value;
  }

 private:
  double low_, high_, at_ = 0, low_value_ = 0, high_value_ = 0;
};

/** Joins what slices made, in their order. */
template <typename T>
std::vector<T> joined(const std::vector<std::vector<T>>& parts) {
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/** Finds lambda. */
class CutSolver {
 public:
  CutSolver(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
            const CutBudget& budget, int threads)
      : cloud_(cloud), budget_(budget), threads_(threads) {
    const double most = std::max(1.0, kRootShare * 1.5 * static_cast<double>(budget.max_cells));
    int growth = 0;
    while (budget.max_cells > 0 &&
           cloud.depth() +
               growth<OctreeCloud::kBits&& static_cast<double>(cloud.countCells(growth))> most) {
      ++growth;
    }
    forests_ = growForests(cloud, source, rule, growth, threads);
  }

  OctreeCut run() {
    double high = 0;
    for (const OctreeForest& forest : forests_) {
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
    for (const OctreeForest& forest : forests_) cut.nodes += forest.nodes.size();
    cut.cells = joined(parts);
    return cut;
  }

 private:
  void solve(double lambda) {
    parallelFor(forests_.size(), threads_, 1,
                [&](std::size_t f, int) { forests_[f].solve(lambda); });
    cells_ = 0;
    error_ = 0;
    for (const OctreeForest& forest : forests_) {
      cells_ += forest.cells;
      error_ += forest.error;
    }
  }

  /** Whether the finest cut already meets the budget. */
  bool fits() const {
    if (budget_.max_cells > 0) return cells_ <= budget_.max_cells;
    return budget_.target_error <= 0 || meanError() >= budget_.target_error;
  }

  double meanError() const { return error_ / static_cast<double>(cloud_.size()); }

  /** Narrows log lambda between a cut too fine and one coarse enough (max_cells), or one fine
   * enough and one too coarse (target_error). \return a lambda that keeps the promise. */
  double search(double highest) {
    const bool by_count = budget_.max_cells > 0;
    const double limit = by_count ? static_cast<double>(budget_.max_cells) : budget_.target_error;
    Bracket bracket(highest * kWidestLambda, highest * 2.0);
    for (int step = 0; step < kMostSteps && !bracket.closed(); ++step) {
      const double lambda = bracket.next(step);
      solve(lambda);
      const double value = by_count ? static_cast<double>(cells_) : meanError();
      const bool kept = value <= limit;
      bracket.narrow(kept == by_count, std::log(std::max(value, 1e-300) / limit));
      if (kept && value >= limit * (1.0 - kCountSlack)) return lambda;
    }
    return by_count ? bracket.high() : bracket.low();
  }

  const OctreeCloud& cloud_;
  const CutBudget& budget_;
  int threads_;
  std::vector<OctreeForest> forests_;
  std::uint64_t cells_ = 0;
  double error_ = 0;
};

}  // namespace

OctreeCut cutOptimally(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                       const CutBudget& budget, int threads) {
  return CutSolver(cloud, source, rule, budget, threads).run();
}

}  // namespace pcl_slim::detail

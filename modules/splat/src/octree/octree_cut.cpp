// SPDX-License-Identifier: BSD-3-Clause
// The best cut of the whole octree for a budget: docs/color_octree_splat_sampler.md, "Parameters".
#include "octree/octree_cut.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/octree_forest.h"
#include "octree/octree_runs.h"

namespace pcl_slim::detail {

namespace {

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
  double next(int step)
  {
    double share = 0.5;
    const bool known = low_value_ != 0 && high_value_ != 0;
    if (known && step % 3 != 2) {
      share = std::clamp(low_value_ / (low_value_ - high_value_), 0.02, 0.98);
    }
    at_ = low_ + share * (high_ - low_);
    return std::exp(at_);
  }

  /** What was there: its logarithm over the limit, and whether that belongs to the upper end. */
  void narrow(bool upper, double value)
  {
    (upper ? high_ : low_) = at_;
    (upper ? high_value_ : low_value_) = value;
  }

 private:
  double low_, high_, at_ = 0, low_value_ = 0, high_value_ = 0;
};

/** Finds lambda. */
class CutSolver {
 public:
  CutSolver(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
            const CutBudget& budget, int threads)
      : cloud_(cloud), budget_(budget), threads_(threads)
  {
    const double most = std::max(1.0, kRootShare * 1.5 * static_cast<double>(budget.max_cells));
    int growth = 0;
    while (budget.max_cells > 0 &&
           cloud.depth() +
               growth<OctreeCloud::kBits&& static_cast<double>(cloud.countCells(growth))> most) {
      ++growth;
    }
    forests_ = growForests(cloud, source, rule, growth, threads);
  }

  OctreeCut run()
  {
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
  void solve(double lambda)
  {
    parallelFor(forests_.size(), threads_, 1,
                [&](std::size_t f, int) { forests_[f].solve(lambda); });
    cells_ = 0;
    error_ = 0;
    for (const OctreeForest& forest : forests_) {
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

  /** Narrows log lambda between a cut too fine and one coarse enough (max_cells), or one fine
   * enough and one too coarse (target_error). \return a lambda that keeps the promise. */
  double search(double highest)
  {
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

OctreeCut
cutOptimally(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
             const CutBudget& budget, int threads)
{
  return CutSolver(cloud, source, rule, budget, threads).run();
}

}  // namespace pcl_slim::detail

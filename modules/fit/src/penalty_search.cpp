// SPDX-License-Identifier: BSD-3-Clause
#include "penalty_search.h"

#include <cmath>
#include <cstdio>

#include "cover/level_cover.h"
#include "cover/start_level.h"

namespace pcl_slim::detail {

namespace {

/** What a cover with a given variance comes to. */
struct CoverResult {
  double leaves = 0, rms = 0;  ///< rms as a share of L
};

std::string
formatted(const char* format, double a, double b)
{
  char text[256];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

class PenaltySearch {
 public:
  PenaltySearch(const PointStore& store, FitSettings& settings, int threads, Progress* progress)
      : store_(store), settings_(settings), threads_(threads), progress_(progress)
  {
  }

  const PenaltySearchConstants& constants() const { return settings_.constants.penalty_search; }

  /** Runs a cover as if lambda were the noise. */
  Error run(double lambda, CoverResult& result)
  {
    settings_.energy.lambda = lambda;
    LevelCover cover(store_, settings_, threads_);
    if (Error error = cover.run(startLevel(store_, settings_), progress_)) return error;
    double weight = 0, sum = 0;
    result = CoverResult();
    for (const LevelCover::Piece& piece : cover.pieces()) {
      for (const SurfelRecord* s = piece.begin; s != piece.end; ++s) {
        if ((s->flags & kSurfelLeaf) == 0) continue;
        result.leaves += 1;
        weight += s->effective_count;
        sum += static_cast<double>(s->effective_count) * s->error * s->error;
      }
    }
    result.rms = weight > 0 ? std::sqrt(sum / weight) / settings_.diagonal : 0.0;
    return {};
  }

  /** Moves log lambda until goal(result) = log(measured / wanted) is 0 within tolerance; the ends
   * of the bracket have opposite signs. Keeps the last lambda whose goal is on the side asked for.
   */
  template <typename Goal>
  Error solve(double low, double goal_low, double high, double goal_high, double least, double most,
              const Goal& goal)
  {
    double log_low = std::log(low), log_high = std::log(high);
    double kept = goal_low >= least && goal_low <= most ? low : high;
    for (int step = 0; step < constants().most_covers; ++step) {
      double share = goal_low / (goal_low - goal_high);
      share = std::min(std::max(share, constants().least_step), 1 - constants().least_step);
      const double middle = log_low + share * (log_high - log_low);
      CoverResult result;
      if (Error error = run(std::exp(middle), result)) return error;
      const double value = goal(result);
      if (value >= least && value <= most) {
        kept = std::exp(middle);
        break;
      }
      ((value < 0) == (goal_low < 0) ? log_low : log_high) = middle;
      ((value < 0) == (goal_low < 0) ? goal_low : goal_high) = value;
      if (value <= most && value < 0) kept = std::exp(middle);
    }
    settings_.energy.lambda = kept;
    return {};
  }

 private:
  const PointStore& store_;
  FitSettings& settings_;
  int threads_;
  Progress* progress_;
};

Error
solveError(PenaltySearch& search, double lambda, double largest, double target)
{
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.rms, 1e-12) / target); };
  CoverResult finest, coarsest;
  if (Error error = search.run(lambda, finest)) return error;
  const double tolerance = std::log(1 + search.constants().error_tolerance);
  if (std::abs(goal(finest)) <= tolerance) return {};
  if (goal(finest) > 0) {
    return {
        ErrorCode::kBadArgument,
        formatted(
            "the target error %g L lies below what noise and density allow: ask for %g L or more",
            target, finest.rms)};
  }
  if (Error error = search.run(largest, coarsest)) return error;
  if (goal(coarsest) <= tolerance) return {};
  return search.solve(lambda, goal(finest), largest, goal(coarsest), -tolerance, tolerance, goal);
}

Error
solveCount(PenaltySearch& search, double lambda, double largest, double most)
{
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.leaves, 0.5) / most); };
  CoverResult finest, coarsest;
  if (Error error = search.run(lambda, finest)) return error;
  if (goal(finest) <= 0) return {};
  if (Error error = search.run(largest, coarsest)) return error;
  if (goal(coarsest) > 0) {
    return {ErrorCode::kBadArgument,
            formatted("%g surfels are too few for this cloud: it needs at least %g", most,
                      coarsest.leaves)};
  }
  return search.solve(lambda, goal(finest), largest, goal(coarsest),
                      std::log(1 - search.constants().count_tolerance), 0.0, goal);
}

}  // namespace

Error
solvePenalty(const PointStore& store, const FitParams& params, FitSettings& settings, int threads,
             Progress* progress)
{
  const PenaltySearchConstants& constants = settings.constants.penalty_search;
  const double measured = std::max(settings.energy.lambda, constants.least_variance);
  const double largest = std::pow(constants.largest_error * settings.diagonal, 2);
  PenaltySearch search(store, settings, threads, progress);
  if (params.max_surfels > 0) {
    return solveCount(search, measured, largest, static_cast<double>(params.max_surfels));
  }
  return solveError(search, measured, largest, params.target_error);
}

}  // namespace pcl_slim::detail

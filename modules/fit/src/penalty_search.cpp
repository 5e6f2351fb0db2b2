// SPDX-License-Identifier: BSD-3-Clause
#include "penalty_search.h"

#include <charconv>
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

/** The number that six significant digits of x name. */
double
rounded(double x)
{
  char text[32];
  const auto written = std::to_chars(text, text + sizeof(text), x, std::chars_format::general, 6);
  std::from_chars(text, written.ptr, x);
  return x;
}

class FactorSearch {
 public:
  FactorSearch(const PointStore& store, FitSettings& settings, double noise, int threads,
               Progress* progress)
      : store_(store), settings_(settings), noise_(noise), threads_(threads), progress_(progress)
  {
  }

  /** Where noise alone decides, and where no surface is left. */
  double least() const { return 1; }
  double most() const
  {
    return rounded(
        std::max(1.0, std::pow(constants().largest_error * settings_.diagonal, 2) / noise_));
  }

  const PenaltySearchConstants& constants() const { return settings_.constants.penalty_search; }

  void apply(double factor) { settings_.energy.lambda = factor * noise_; }

  Error run(double factor, CoverResult& result)
  {
    apply(factor);
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

  /** Moves the factor's logarithm until goal(result) = log(measured / wanted) is 0 within tolerance; the ends
   * of the bracket have opposite signs. Keeps the last factor whose goal is on the side asked for.
   */
  template <typename Goal>
  Error solve(double goal_low, double goal_high, double least_goal, double most_goal,
              const Goal& goal, double& kept)
  {
    double log_low = std::log(least()), log_high = std::log(most());
    kept = goal_low >= least_goal && goal_low <= most_goal ? least() : most();
    for (int step = 0; step < constants().most_covers; ++step) {
      double share = goal_low / (goal_low - goal_high);
      share = std::min(std::max(share, constants().least_step), 1 - constants().least_step);
      const double factor = rounded(std::exp(log_low + share * (log_high - log_low)));
      CoverResult result;
      if (Error error = run(factor, result)) return error;
      const double value = goal(result);
      if (value <= most_goal && (value >= least_goal || value < 0)) kept = factor;
      if (value >= least_goal && value <= most_goal) break;
      ((value < 0) == (goal_low < 0) ? log_low : log_high) = std::log(factor);
      ((value < 0) == (goal_low < 0) ? goal_low : goal_high) = value;
    }
    return {};
  }

 private:
  const PointStore& store_;
  FitSettings& settings_;
  double noise_;
  int threads_;
  Progress* progress_;
};

Error
solveError(FactorSearch& search, double target, double& factor)
{
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.rms, 1e-12) / target); };
  CoverResult finest, coarsest;
  factor = search.least();
  if (Error error = search.run(factor, finest)) return error;
  const double tolerance = std::log(1 + search.constants().error_tolerance);
  if (std::abs(goal(finest)) <= tolerance) return {};
  if (goal(finest) > 0) {
    return {
        ErrorCode::kBadArgument,
        formatted(
            "the target error %g L lies below what noise and density allow: ask for %g L or more",
            target, finest.rms)};
  }
  factor = search.most();
  if (Error error = search.run(factor, coarsest)) return error;
  if (goal(coarsest) <= tolerance) return {};
  return search.solve(goal(finest), goal(coarsest), -tolerance, tolerance, goal, factor);
}

Error
solveCount(FactorSearch& search, double most, double& factor)
{
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.leaves, 0.5) / most); };
  CoverResult finest, coarsest;
  factor = search.least();
  if (Error error = search.run(factor, finest)) return error;
  if (goal(finest) <= 0) return {};
  factor = search.most();
  if (Error error = search.run(factor, coarsest)) return error;
  if (goal(coarsest) > 0) {
    return {ErrorCode::kBadArgument,
            formatted("%g surfels are too few for this cloud: it needs at least %g", most,
                      coarsest.leaves)};
  }
  return search.solve(goal(finest), goal(coarsest),
                      std::log(1 - search.constants().count_tolerance), 0.0, goal, factor);
}

}  // namespace

Error
applyNoiseFactor(const PointStore& store, const FitParams& params, FitSettings& settings,
                 int threads, Progress* progress, double& factor)
{
  factor = params.noise_factor;
  if (factor == 0 && params.target_error == 0 && params.max_surfels == 0) return {};
  const double noise =
      std::max(settings.energy.lambda, settings.constants.penalty_search.least_variance);
  FactorSearch search(store, settings, noise, threads, progress);
  Error error;
  if (params.max_surfels > 0)
    error = solveCount(search, static_cast<double>(params.max_surfels), factor);
  else if (params.target_error > 0)
    error = solveError(search, params.target_error, factor);
  search.apply(factor);
  return error;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): the fits at the radii of eq. (5), and
// between; the minimum-support radius is that of "Guards", Minimum support.
#pragma once

#include <algorithm>
#include <cstdint>

#include "fit_plan.h"
#include "least_squares/local_fit.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief The samples of one gathered ball, and copies of its inner parts.
 *
 * The radii of a level are in [gamma^2, 1] r_r (eq. 5). The points within gamma r_r and those
 * within gamma^2 r_r are copied when a radius first needs no more than them, so that small radii
 * do not read the whole ball. Radii are in units of the gather radius. There is one object per
 * thread, which keeps its scratch memory.
 */
class BallSamples {
 public:
  /** \brief Starts on a ball in frame coordinates, which must stay as it is until the next one.
   * \param[in] gather_radius local length; \param[in] rho_right r_r in units of it. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right);

  /** \brief All points, or a smaller copy that still contains all within rho. O(points) when new. */
  const BallBuffer& within(double rho);

  const BallBuffer& all() const { return *ball_; }
  double gatherRadius() const { return gather_radius_; }
  double rhoRight() const { return rho_right_; }

 private:
  const BallBuffer* ball_ = nullptr;
  BallBuffer middle_, inner_;
  bool has_middle_ = false, has_inner_ = false;
  double gather_radius_ = 0, rho_right_ = 1;
};

/** \brief A radius that was tried; rho is in units of the ball's gather radius. */
struct Trial {
  double rho = 0;
  LocalFit fit;
  double energy = 0;
  bool supported = false;  ///< the full degree could be fitted with enough points
};

/** \brief Systems solved, those whose degree fell and why, and the worst pivot of those kept. */
struct FitCounts {
  std::uint64_t fits = 0, fell_by_support = 0, fell_by_pivot = 0;
  double least_pivot = 1;  ///< over its diagonal entry, of refined fits

  FitCounts& operator+=(const FitCounts& other)
  {
    fits += other.fits;
    fell_by_support += other.fell_by_support;
    fell_by_pivot += other.fell_by_pivot;
    least_pivot = std::min(least_pivot, other.least_pivot);
    return *this;
  }
};

/** \brief Fits the samples of one ball at any radius and degree. One per thread.
 *
 * Every fit costs O(points within the radius) and counts in counts(). */
class TrialFits {
 public:
  explicit TrialFits(const FitPlan& plan) : plan_(plan), energy_(plan.energy) {}

  /** \brief The noise variance of the balls to come. */
  void setNoise(double lambda) { energy_.lambda = lambda; }
  double noise() const { return energy_.lambda; }

  /** \brief Starts on a ball; see BallSamples::begin. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right);

  /** \brief The fit at r_r, made once for a ball. */
  const Trial& right();

  /** \brief The fits at r_m = gamma r_r and r_l = gamma^2 r_r of eq. (5). */
  Trial middle() { return at(kGolden * samples_.rhoRight()); }
  Trial left() { return at(rhoLeft()); }
  double rhoLeft() const { return kGolden * kGolden * samples_.rhoRight(); }

  /** \brief The fit at a radius; unsupported where the points are too few for the degree. */
  Trial at(double rho) { return at(rho, plan_.degree, plan_.fit_kernel); }
  Trial at(double rho, int degree, WeightKernel kernel);

  /** \brief The smallest radius up to from at which n_eff still is the least support, to about 1 %;
   * from where there is none. */
  double minimumSupportRadius(double from, int degree, WeightKernel kernel);

  /** \brief The fit of the full degree at the minimum-support radius. Bias rules there, so the
   * flatter kernel is taken: it reaches the same n_eff with a smaller ball. */
  Trial atMinimumSupport(double from);

  /** \brief The fit of a lower degree to a trial's points, from its moments where they suffice. */
  Trial ofLowerDegree(const Trial& trial, int degree);

  /** \brief Fits the trial's degree and radius to the points with iterative refinement.
   * \return false where that degree fails; the trial is then left alone. */
  bool refit(const BallBuffer& points, WeightKernel kernel, Trial& trial);

  /** \brief e^2 across the surface, a local length squared. */
  double variance(const Trial& trial) const
  {
    return energy_.variance(trial.fit, samples_.gatherRadius());
  }

  /** \brief A trial's radius as a local length. */
  double radiusOf(const Trial& trial) const { return trial.rho * samples_.gatherRadius(); }

  /** \brief What a trial costs by an energy other than the search's own. */
  double energyOf(const Trial& trial, const Energy& energy) const
  {
    return energy(trial.fit, radiusOf(trial), samples_.gatherRadius(), constants());
  }

  BallSamples& samples() { return samples_; }
  const BallSamples& samples() const { return samples_; }
  const Energy& energy() const { return energy_; }
  const FitPlan& plan() const { return plan_; }
  const RadiusConstants& constants() const { return plan_.constants.radius; }
  const FitCounts& counts() const { return counts_; }

 private:
  const FitPlan& plan_;
  Energy energy_;
  BallSamples samples_;
  Trial right_;
  bool has_right_ = false;
  FitCounts counts_;
};

}  // namespace pcl_slim::detail

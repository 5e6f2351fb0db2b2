// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): the door of this room, for one ball at a
// time.
#pragma once

#include <memory>
#include <vector>

#include "radius/residual_tests.h"
#include "radius/trial_fits.h"

namespace pcl_slim::detail {

/** \brief Three trials a < b < c of which the middle one costs least. */
struct Bracket {
  Trial a, b, c;

  /** \brief One parabolic step in log r and log E towards the minimum near b. One fit. */
  void narrow(TrialFits& trials);

  /** \brief log(c / a). */
  double width() const;
};

/** \brief Where the search over one sliding interval ended. */
struct RadiusChoice {
  enum class Kind {
    kLeaf,      ///< a radius was found
    kInternal,  ///< the minimum is at smaller radii: a later level will find it
    kSparse     ///< too few points at r_r: see fallBackWhereSparse()
  };
  Kind kind = Kind::kInternal;
  Trial trial;                   ///< the leaf's, or the fit at r_r for an internal node
  bool support_limited = false;  ///< a leaf that ended at minimum support
  bool without_detail = false;   ///< a leaf that was found to hide no detail

  static RadiusChoice leaf(const Trial& trial) { return {Kind::kLeaf, trial}; }
  static RadiusChoice supportLimited(const Trial& trial) { return {Kind::kLeaf, trial, true}; }
  static RadiusChoice withoutDetail(const Trial& trial)
  {
    return {Kind::kLeaf, trial, false, true};
  }
  static RadiusChoice internal(const Trial& right) { return {Kind::kInternal, right}; }
  static RadiusChoice sparse(const Trial& trial) { return {Kind::kSparse, trial}; }
};

/** \brief A rule that chooses the radius of one ball from trial fits. */
class RadiusRule {
 public:
  RadiusRule() = default;
  RadiusRule(const RadiusRule&) = delete;
  RadiusRule& operator=(const RadiusRule&) = delete;
  virtual ~RadiusRule() = default;

  /** \brief The choice on [gamma^2, 1] r_r. */
  virtual RadiusChoice choose() = 0;

  /** \brief Whether a smaller radius is needed beyond doubt, seen on a part of a ball's points. */
  virtual bool surelyInternal() = 0;
};

/** \brief Makes the fit of a leaf that is kept. One per thread: it keeps its scratch memory. */
class FinalFit {
 public:
  explicit FinalFit(TrialFits& trials) : trials_(trials) {}

  /** \brief The chosen fit once more, with iterative refinement and, if requested, robust weights. */
  Trial make(const RadiusChoice& choice);

 private:
  void fitRobustly(WeightKernel kernel, Trial& trial);
  void setRobustWeights(const LocalFit& fit);

  TrialFits& trials_;
  BallBuffer robust_;
  std::vector<float> residuals_;
};

/** \brief Seeks the radius of one gathered ball (the paper's section 2, "Optimal surfel radius").
 *
 * E is evaluated at r_r, r_m and r_l of eq. (5) and at few radii between, each from the same
 * gathered points; the paper's rule or ours, settled once, chooses among them. There is one object
 * per thread, which keeps its scratch memory; the plan must outlive it.
 */
class RadiusSearch {
 public:
  explicit RadiusSearch(const FitPlan& plan);
  RadiusSearch(const RadiusSearch&) = delete;  // its parts refer to each other
  RadiusSearch& operator=(const RadiusSearch&) = delete;

  /** \brief The noise variance of the balls to come. */
  void setNoise(double lambda) { trials_.setNoise(lambda); }
  double noise() const { return trials_.noise(); }

  /** \brief Starts on a ball in frame coordinates. \param[in] gather_radius local length;
   * \param[in] rho_right r_r in units of it. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right)
  {
    trials_.begin(ball, gather_radius, rho_right);
  }

  /** \brief The fit at r_r. */
  const Trial& right() { return trials_.right(); }

  /** \brief The choice on [gamma^2, 1] rho_right. */
  RadiusChoice search();

  /** \brief Whether a smaller radius is needed beyond doubt, seen on a part of a ball's points. */
  bool surelyInternal() { return !isNarrowest() && rule_->surelyInternal(); }

  /** \brief For a sparse ball: the best that degree and radius up to the gather radius allow. */
  RadiusChoice fallBack();

  /** \brief The final fit of a leaf, with refinement and, if requested, robust weights. */
  Trial refine(const RadiusChoice& choice) { return final_.make(choice); }

  const FitCounts& counts() const { return trials_.counts(); }

 private:
  /** \brief Whether balls of the next level would be narrower than the least one allowed. */
  bool isNarrowest() const;
  /** \brief A choice at the least radius allowed, in place of one of a narrower ball. */
  RadiusChoice notNarrower(const RadiusChoice& choice);

  TrialFits trials_;
  ResidualTests tests_;
  FinalFit final_;
  std::unique_ptr<RadiusRule> rule_;
};

}  // namespace pcl_slim::detail

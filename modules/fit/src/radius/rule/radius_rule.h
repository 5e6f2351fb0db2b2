// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): what every rule for choosing a radius
// answers.
#pragma once

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
    kInternal,  ///< the minimum lies at smaller radii: a later level will find it
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

/** \brief The choice where support ends between the supported radii and the next one down: the last
 * radius that has it joins the comparison ("Guards", Minimum support). */
RadiusChoice
chooseAtMinimumSupport(TrialFits& trials, const Trial& right, const Trial& middle);

}  // namespace pcl_slim::detail

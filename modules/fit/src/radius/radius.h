// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): the fits at the radii of eq. (5) and
// between, the tests of their residuals ("Guards", "Detail below the noise", "Two fits on the
// same points"), and the search over one ball.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fit_plan.h"
#include "least_squares/least_squares.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief The tuning constants of the search for a ball's radius.
 *
 * Each group names the paragraph of docs/theory.md that explains it. "Ratio" means a number
 * without a unit; lambda is the noise variance, P the number of coefficients, n_eff the effective
 * number of points, e the RMS residual and r the radius.
 */
struct RadiusConstants {
  // "One fit, step by step", 3 (Levels): a ball that is divided after a look at part of its points.
  double sure_margin = 1.3;  ///< ratio of E, or of e^2, that a part of the points cannot miss

  // "One fit, step by step", 5 (Radius): a minimum of E inside the interval.
  int lenient_steps = 2;  ///< number of bisections of log r for the largest radius allowed

  // "Not reproduced": where the paper's rule ends its bracket.
  int brent_steps = 6;        ///< number of parabolic steps at most
  double brent_width = 0.05;  ///< ratio; width of the bracket in log r, far within which E is flat

  // "Guards", Minimum support.
  int support_steps = 8;         ///< number of steps towards the minimum-support radius at most
  double support_margin = 1.02;  ///< ratio; n_eff up to this many times the least support will do
  double support_aim = 1.01;     ///< ratio of n_eff to the least support that a step aims at
  double support_lenience =
      1.3;  ///< ratio of E; a wider ball is taken up to this many times E there

  // "Guards", Thin data.
  double scattered_ratio = 0.02;  ///< e / r beyond which few points make no surface

  // "Two fits on the same points".
  double noise_like = 1.5;         ///< e^2 [lambda] up to which a ball contains only noise
  double comparison_rise = 1.3;    ///< ratio of E beyond which the wide ball's rim is off too far
  double comparison_worth = 0.46;  ///< ratio of D^2 to the variance saved, times kappa
  double comparison_trust = 2.0;   ///< factor on that if E favours the wide ball as well
  int comparison_radii = 4;        ///< number of radii from r_r down to r_m, r_r among them
  int least_degree = 2;            ///< lowest degree that is compared
  double degree_support = 9.0;     ///< n_eff / P from which a degree can be found to be too high

  // "Detail below the noise".
  double detail_support = 8.0;     ///< ratio of n_eff to the least support, for finer balls
  double detail_deviations = 3.0;  ///< ratio of shared variance to its deviation, at least
  double detail_worth = 0.5;       ///< ratio of the shared variance to the penalty on E, at least
  double detail_cell = 3.0;        ///< least width of a cell in units of sqrt(lambda)
  double points_per_cell = 8.0;    ///< number of points; more would hide fine detail
  int least_cells = 2;             ///< number of cells along a side
  int most_cells = 32;             ///< number of cells along a side
  double absorbed_share = 0.4;  ///< of P / n_eff; what a fit follows of the noise in its inner part

  // "Degree at features".
  int feature_degree = 2;        ///< the degree that is tried there
  int feature_steps = 4;         ///< number of radii tried for it
  double feature_step = 0.75;    ///< ratio of each of these radii to the last
  double feature_support = 1.5;  ///< n_eff / P that it needs
  double feature_noise = 1.15;   ///< e^2 in units of lambda that is more than noise
  double feature_height = 0.01;  ///< e / r that no smooth surface leaves
  double feature_gain = 0.9;     ///< ratio of expected errors that the lower degree must reach

  // "Guards", The fit that is kept, and outliers.
  int robust_passes = 2;      ///< number of fits with robust weights
  double robust_scale = 2.5;  ///< scale of the weights in deviations of the noise
};

inline constexpr RadiusConstants kRadiusConstants;

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

  /** \brief All points, or a smaller copy that still contains all within rho. O(points) when new.
   */
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

  FitCounts& operator+=(const FitCounts& other) {
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
  explicit TrialFits(const FitPlan& plan, const RadiusConstants& constants = kRadiusConstants)
      : plan_(plan), constants_(constants), energy_(plan.energy) {}

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
  double variance(const Trial& trial) const {
    return energy_.variance(trial.fit, samples_.gatherRadius());
  }

  /** \brief A trial's radius as a local length. */
  double radiusOf(const Trial& trial) const { return trial.rho * samples_.gatherRadius(); }

  /** \brief What a trial costs by an energy other than the search's own. */
  double energyOf(const Trial& trial, const Energy& energy) const {
    return energy(trial.fit, radiusOf(trial), samples_.gatherRadius());
  }

  BallSamples& samples() { return samples_; }
  const BallSamples& samples() const { return samples_; }
  const Energy& energy() const { return energy_; }
  const FitPlan& plan() const { return plan_; }
  const RadiusConstants& constants() const { return constants_; }
  const FitCounts& counts() const { return counts_; }

 private:
  const FitPlan& plan_;
  const RadiusConstants& constants_;
  Energy energy_;
  BallSamples samples_;
  Trial right_;
  bool has_right_ = false;
  FitCounts counts_;
};

}  // namespace pcl_slim::detail

namespace pcl_slim::detail {

/** \brief Separates a surface's unresolved detail from noise by the covariance of neighbouring
 * residuals.
 *
 * Noise differs from point to point; detail that a fit misses is common to points that are close
 * together in the frame's plane. The mean product of residuals over all pairs within small cells
 * of (u, v) therefore estimates the detail's variance, whatever the noise is: a lack-of-fit test
 * with near replicates. One object per thread: it keeps its scratch memory.
 */
class ResidualStructure {
 public:
  explicit ResidualStructure(const RadiusConstants& constants) : constants_(constants) {}

  struct Finding {
    double share = 0;      ///< of e^2 that neighbours have in common
    double deviation = 0;  ///< standard deviation of share where there is noise alone; 0: unknown
  };

  /** \brief Looks at the residuals of a fit within rho. \param[in] least_cell least width of a
   * cell; 0: from the points' density. \param[in] correlation points that share their noise.
   * O(points). */
  Finding measure(const BallBuffer& points, const LocalFit& fit, double rho,
                  double least_cell = 0.0, double correlation = 1.0);

 private:
  /** \brief A cell of the frame's plane. */
  struct Cell {
    float count, sum;  ///< points and the sum of their residuals
  };

  int cellsAlongSide(double points, double rho, double least_cell) const;
  double fillCells(const BallBuffer& points, double rho, int side);

  const RadiusConstants& constants_;
  std::vector<float> residuals_;
  std::vector<Cell> cells_;
};

/** \brief Decides whether the residuals of a fit are noise, lack of fit, or detail below the noise.
 */
class ResidualTests {
 public:
  explicit ResidualTests(TrialFits& trials) : trials_(trials), structure_(trials.constants()) {}

  /** \brief The residual is no larger than noise makes it. */
  bool isNoise(const Trial& trial) const {
    return trials_.variance(trial) <= trials_.constants().noise_like * trials_.noise();
  }

  /** \brief The smaller residual of two fits is beyond what noise explains, times a margin. */
  bool lacksFit(const Trial& left, const Trial& middle, double margin = 1.0) const;
  bool lacksFit(const Trial& trial) const { return lacksFit(trial, trial); }

  /** \brief Neighbouring residuals share so much that smaller balls are worth their noise.
   * O(points). */
  bool hidesDetail(const Trial& trial);

 private:
  TrialFits& trials_;
  ResidualStructure structure_;
};

/** \brief Compares a simpler fit, of a wider ball or a lower degree, with a closer one on the same
 * points.
 *
 * E compares radii over different points: a narrow ball's is often lower by luck, or because the
 * wide one's rim bends more than a polynomial, which hardly counts: where leaves are blended by
 * the weights they were fitted with, such errors of neighbours cancel to first order. On the same
 * points noise cancels: if both fits are unbiased, their mean squared difference D^2 is about the
 * variance that the simpler one saves, lambda (P_close / n_close - P_simpler / n_simpler).
 */
class FitComparison {
 public:
  FitComparison(TrialFits& trials, ResidualTests& tests) : trials_(trials), tests_(tests) {}

  /** \brief Whether the simpler fit costs the closer one's points less than it saves them.
   * \param[in] trust as many times as much may be lost. O(P^2). */
  bool acceptsSimpler(const Trial& simpler, const Trial& close, double trust = 1.0) const;

  /** \brief The widest ball from r_r down to r_m, r_m left out, that is accepted in place of r_m's
   * and hides no detail: r_r, or else upwards from r_m. \return an unsupported trial where there
   * is none. */
  Trial widestAccepted(const Trial& middle, const Trial& right);

  /** \brief The fit of the lowest degree that is accepted in place of a leaf's: under noise the
   * high terms of a ball that cannot be wide are little else. */
  Trial lowestDegreeAccepted(const Trial& trial);

 private:
  std::array<double, kMaxCoefficients> unbiased(const Trial& trial) const;
  double meanSquaredDifference(const Trial& simpler, const Trial& close) const;

  TrialFits& trials_;
  ResidualTests& tests_;
};

}  // namespace pcl_slim::detail

namespace pcl_slim::detail {

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
  static RadiusChoice withoutDetail(const Trial& trial) {
    return {Kind::kLeaf, trial, false, true};
  }
  static RadiusChoice internal(const Trial& right) { return {Kind::kInternal, right}; }
  static RadiusChoice sparse(const Trial& trial) { return {Kind::kSparse, trial}; }
};

class RadiusRule;

/** \brief Makes the fit of a leaf that is kept. One per thread: it keeps its scratch memory. */
class FinalFit {
 public:
  explicit FinalFit(TrialFits& trials) : trials_(trials) {}

  /** \brief The chosen fit once more, with iterative refinement and, if requested, robust weights.
   */
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
  ~RadiusSearch();

  /** \brief The noise variance of the balls to come. */
  void setNoise(double lambda) { trials_.setNoise(lambda); }
  double noise() const { return trials_.noise(); }

  /** \brief Starts on a ball in frame coordinates. \param[in] gather_radius local length;
   * \param[in] rho_right r_r in units of it. */
  void begin(const BallBuffer& ball, double gather_radius, double rho_right) {
    trials_.begin(ball, gather_radius, rho_right);
  }

  /** \brief The fit at r_r. */
  const Trial& right() { return trials_.right(); }

  /** \brief The choice on [gamma^2, 1] rho_right. */
  RadiusChoice search();

  /** \brief Whether a smaller radius is needed beyond doubt, seen on a part of a ball's points. */
  bool surelyInternal();

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

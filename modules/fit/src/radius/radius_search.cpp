// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

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

namespace {

/** \brief Three trials a < b < c of which the middle one costs least. */
struct Bracket {
  Trial a, b, c;

  /** \brief One parabolic step in log r and log E towards the minimum near b. One fit. */
  void narrow(TrialFits& trials);

  /** \brief log(c / a). */
  double width() const;
};

/** Abscissa of the minimum of the parabola through three points of (log rho, log E). */
double parabolaMinimum(const Trial& a, const Trial& b, const Trial& c) {
  const double xa = std::log(a.rho), xb = std::log(b.rho), xc = std::log(c.rho);
  const double fa = std::log(a.energy), fb = std::log(b.energy), fc = std::log(c.energy);
  const double p = (xb - xa) * (fb - fc), q = (xb - xc) * (fb - fa);
  const double denominator = p - q;
  const double x = std::abs(denominator) > 1e-300
                       ? xb - 0.5 * ((xb - xa) * p - (xb - xc) * q) / denominator
                       : xb;
  return std::exp(std::min(std::max(x, xa), xc));
}

void Bracket::narrow(TrialFits& trials) {
  const Trial trial = trials.at(parabolaMinimum(a, b, c));
  if (!trial.supported || trial.rho == b.rho) return;
  if (trial.energy < b.energy) {
    (trial.rho < b.rho ? c : a) = b;
    b = trial;
  } else {
    (trial.rho < b.rho ? a : c) = trial;
  }
}

double Bracket::width() const {
  return std::log(c.rho / a.rho);
}

/** \brief The choice where support ends between the supported radii and the next one down: the
 * least supported radius joins the comparison ("Guards", Minimum support). */
RadiusChoice chooseAtMinimumSupport(TrialFits& trials, const Trial& right, const Trial& middle) {
  const double lenience = trials.constants().support_lenience;
  const Trial last = trials.atMinimumSupport(middle.rho);
  const auto fitsAsWell = [&](const Trial& wider) {
    return !last.supported || wider.energy <= lenience * last.energy;
  };
  if (right.energy <= trials.plan().lenience * middle.energy && fitsAsWell(right)) {
    return RadiusChoice::leaf(right);
  }
  return fitsAsWell(middle) ? RadiusChoice::leaf(middle) : RadiusChoice::supportLimited(last);
}

/** \brief The default rule: the widest ball and the lowest degree that cost their points nothing.
 *
 * The choice goes by the penalised E(r); lack of fit and detail below the noise send a ball on to
 * smaller radii, and the edge of a feature to a lower degree. */
class PenaltyRadiusRule : public RadiusRule {
 public:
  PenaltyRadiusRule(TrialFits& trials, ResidualTests& tests)
      : trials_(trials), tests_(tests), comparison_(trials, tests) {}

  RadiusChoice choose() override;

  /** \brief Whether E at all three radii, or lack of fit, favours smaller ones by more than chance.
   */
  bool surelyInternal() override;

 private:
  RadiusChoice chooseByEnergy();
  RadiusChoice chooseInside(const Trial& left, const Trial& middle, const Trial& right);
  Trial largestLenient(const Trial& best, const Trial& right);
  bool isLenient(const Trial& wide, const Trial& least) const;

  TrialFits& trials_;
  ResidualTests& tests_;
  FitComparison comparison_;
};

/** \brief Whether the residual exceeds both the noise and what any smooth surface leaves: the ball
 * is at a feature. */
bool liesBesideFeature(const TrialFits& trials, const Trial& trial) {
  const RadiusConstants& constants = trials.constants();
  if (!trials.plan().find_detail || trial.fit.degree <= constants.feature_degree) return false;
  const double e_sq = trials.variance(trial), r = trials.radiusOf(trial);
  return e_sq > constants.feature_height * constants.feature_height * r * r &&
         e_sq > constants.feature_noise * trials.noise();
}

/** \brief Whether points are scattered about a fit rather than on it. */
bool areScattered(const TrialFits& trials, const ResidualTests& tests, const Trial& trial) {
  const double ratio = trials.constants().scattered_ratio;
  return tests.lacksFit(trial) && trial.fit.residual_sq > ratio * ratio * trial.rho * trial.rho;
}

/** \brief The fit of a low degree in a smaller ball that beats a trial by its expected error.
 *
 * Across an edge no degree fits, and a lower one needs less room. Where points are scattered about
 * the trial, planes and all smaller balls with support are tried, too. \return an unsupported trial
 * where none is better. Up to feature_steps fits; about 20 where points are scattered. */
Trial fitBesideFeature(TrialFits& trials, const Trial& trial, bool scattered) {
  const RadiusConstants& constants = trials.constants();
  // Kappa is 1 for the expected error: the excess next to an edge is bias, not chance.
  Energy risk = trials.energy();
  risk.kappa = 1.0;
  Trial best;
  double least = constants.feature_gain * trials.energyOf(trial, risk);
  const int least_degree = scattered ? 1 : constants.feature_degree;
  for (int degree = constants.feature_degree; degree >= least_degree; --degree) {
    const double enough = constants.feature_support * numCoefficients(degree);
    double rho = trial.rho;
    for (int step = 0; scattered || step < constants.feature_steps; ++step) {
      const Trial low = trials.at(rho, degree, trials.plan().fit_kernel);
      if (!low.supported || low.fit.n_eff < enough) break;
      rho *= constants.feature_step;
      const double cost = trials.energyOf(low, risk);
      if (cost >= least) continue;
      best = low;
      least = cost;
    }
  }
  return best;
}

RadiusChoice PenaltyRadiusRule::choose() {
  const RadiusChoice choice = chooseByEnergy();
  if (choice.kind != RadiusChoice::Kind::kLeaf) return choice;
  if (liesBesideFeature(trials_, choice.trial)) {
    const bool scattered = areScattered(trials_, tests_, choice.trial);
    const Trial low = fitBesideFeature(trials_, choice.trial, scattered);
    if (low.supported) return RadiusChoice::leaf(low);
  }
  if (choice.support_limited) return choice;
  if (!choice.without_detail && tests_.hidesDetail(choice.trial)) {
    return RadiusChoice::internal(trials_.right());
  }
  return RadiusChoice::leaf(comparison_.lowestDegreeAccepted(choice.trial));
}

RadiusChoice PenaltyRadiusRule::chooseByEnergy() {
  const Trial& right = trials_.right();
  if (!right.supported) return RadiusChoice::sparse(right);
  const Trial middle = trials_.middle();
  if (!middle.supported) return chooseAtMinimumSupport(trials_, right, right);
  const bool flat = isLenient(right, middle);
  if (tests_.isNoise(middle)) {
    if (trials_.plan().compare_nested) {
      const Trial wide = comparison_.widestAccepted(middle, right);
      if (wide.supported) return RadiusChoice::withoutDetail(wide);
    } else if (flat) {
      return RadiusChoice::leaf(right);  // E is flat down to the noise: take the largest radius.
    }
  }
  if (trials_.energy().filledByNoise(trials_.rhoLeft() * trials_.samples().gatherRadius())) {
    return RadiusChoice::leaf(flat ? right : middle);
  }
  const Trial left = trials_.left();
  if (!left.supported) return chooseAtMinimumSupport(trials_, right, middle);
  if (tests_.lacksFit(left, middle)) return RadiusChoice::internal(right);
  return chooseInside(left, middle, right);
}

RadiusChoice PenaltyRadiusRule::chooseInside(const Trial& left, const Trial& middle,
                                             const Trial& right) {
  const Trial& least = left.energy < middle.energy ? left : middle;
  if (isLenient(right, least)) return RadiusChoice::leaf(right);
  if (left.energy < middle.energy) return RadiusChoice::internal(right);
  // A minimum is inside (rule 4, first half).
  Bracket bracket{left, middle, right};
  bracket.narrow(trials_);
  if (trials_.plan().lenience > 1.0) {
    return RadiusChoice::leaf(largestLenient(bracket.b, right));
  }
  bracket.narrow(trials_);
  return RadiusChoice::leaf(bracket.b);
}

/** Whether E of a wide ball is within the tolerance of the least E. Under noise E is flat, and its
 * minimum is at balls that are too small. */
bool PenaltyRadiusRule::isLenient(const Trial& wide, const Trial& least) const {
  return wide.energy <= trials_.plan().lenience * least.energy;
}

/** The largest radius up to right's with E <= lenience E_min, by bisection of log r. */
Trial PenaltyRadiusRule::largestLenient(const Trial& best, const Trial& right) {
  if (isLenient(right, best)) return right;
  Trial inside = best;
  double outside = right.rho;
  for (int step = 0; step < trials_.constants().lenient_steps; ++step) {
    const Trial trial = trials_.at(std::sqrt(inside.rho * outside));
    if (trial.supported && isLenient(trial, best)) {
      inside = trial;
    } else {
      outside = trial.rho;
    }
  }
  return inside;
}

bool PenaltyRadiusRule::surelyInternal() {
  const double margin = trials_.constants().sure_margin;
  const Trial& right = trials_.right();
  if (!right.supported) return false;
  const Trial middle = trials_.middle(), left = trials_.left();
  if (!middle.supported || !left.supported) return false;
  if (tests_.lacksFit(left, middle, margin)) return true;
  return margin * left.energy < middle.energy && margin * middle.energy < right.energy;
}

/** \brief The paper's rule: the least E(r) of eq. (3) on the interval of eq. (5), by rule (4). */
class PaperRadiusRule : public RadiusRule {
 public:
  explicit PaperRadiusRule(TrialFits& trials) : trials_(trials) {}

  RadiusChoice choose() override;

  /** \brief Never: the paper looks at all points of a ball. */
  bool surelyInternal() override { return false; }

 private:
  RadiusChoice chooseAmong(const Trial& left, const Trial& middle, const Trial& right);

  TrialFits& trials_;
};

RadiusChoice PaperRadiusRule::choose() {
  const Trial& right = trials_.right();
  if (!right.supported) return RadiusChoice::sparse(right);
  const Trial middle = trials_.middle();
  if (!middle.supported) return chooseAtMinimumSupport(trials_, right, right);
  const Trial left = trials_.left();
  if (!left.supported) return chooseAtMinimumSupport(trials_, right, middle);
  return chooseAmong(left, middle, right);
}

/** Rule (4), with the clamp at r_r where E_l > E_m >= E_r, and Brent's parabolic steps. */
RadiusChoice PaperRadiusRule::chooseAmong(const Trial& left, const Trial& middle,
                                          const Trial& right) {
  if (left.energy > middle.energy && middle.energy >= right.energy) {
    return RadiusChoice::leaf(right);
  }
  const bool bracketed = left.energy > middle.energy && middle.energy < right.energy;
  const bool monotone = left.fit.residual_sq < middle.fit.residual_sq &&
                        middle.fit.residual_sq < right.fit.residual_sq;
  if (!bracketed || !monotone) return RadiusChoice::internal(right);
  const RadiusConstants& constants = trials_.constants();
  Bracket bracket{left, middle, right};
  for (int step = 0; step < constants.brent_steps && bracket.width() > constants.brent_width;
       ++step) {
    bracket.narrow(trials_);
  }
  return RadiusChoice::leaf(bracket.b);
}

/** A support-limited leaf, unless its few points are scattered about it. */
RadiusChoice surfaceOrNothing(const TrialFits& trials, const ResidualTests& tests,
                              const Trial& trial) {
  return areScattered(trials, tests, trial) ? RadiusChoice::sparse(trial)
                                            : RadiusChoice::supportLimited(trial);
}

/** The highest degree with support at r_r, else at the gather radius; degree 0 where there is none.
 */
Trial fitOfLowerDegree(TrialFits& trials, const Trial& wide) {
  const Trial lower = trials.at(trials.samples().rhoRight());
  return lower.fit.degree > 0 ? lower : wide;
}

/** \brief The best that degree and radius up to the gather radius allow a sparse ball.
 *
 * \return a support-limited leaf; or a sparse ball where no plane can be fitted, or where the few
 * points are scattered about the fit rather than on it. */
RadiusChoice fallBackWhereSparse(TrialFits& trials, const ResidualTests& tests) {
  const Trial wide = trials.at(1.0);
  if (wide.supported) {
    const Trial least = trials.atMinimumSupport(1.0);
    return surfaceOrNothing(trials, tests, least.supported ? least : wide);
  }
  const Trial lower = fitOfLowerDegree(trials, wide);
  const int degree = lower.fit.degree;
  if (degree == 0) return RadiusChoice::sparse(lower);
  // No wider than the lower degree needs: a few lone points are no surface all over the ball.
  const WeightKernel kernel = trials.plan().fit_kernel;
  const double rho = trials.minimumSupportRadius(lower.rho, degree, kernel);
  const Trial least = trials.at(rho, degree, kernel);
  return surfaceOrNothing(trials, tests, least.supported ? least : lower);
}

}  // namespace

Trial FinalFit::make(const RadiusChoice& choice) {
  const FitPlan& plan = trials_.plan();
  const Trial& chosen = choice.trial;
  const bool at_minimum_support = choice.support_limited && chosen.supported;
  const WeightKernel kernel = at_minimum_support ? plan.wall_kernel : plan.fit_kernel;
  Trial result = chosen;
  if (!trials_.refit(trials_.samples().within(result.rho), kernel, result)) {
    return chosen;  // rounding, or the other kernel, cost a pivot: the accepted fit is kept
  }
  if (plan.robust) fitRobustly(kernel, result);
  return result;
}

/** Fits again with robust weights. e stays that of all points, so that the cover includes outlying
 * points within 5 e. */
void FinalFit::fitRobustly(WeightKernel kernel, Trial& trial) {
  kernels::compactBall(trials_.samples().all(), static_cast<float>(trial.rho * trial.rho), robust_);
  const double spread_sq = trial.fit.residual_sq;
  for (int pass = 0; pass < trials_.constants().robust_passes; ++pass) {
    setRobustWeights(trial.fit);
    if (!trials_.refit(robust_, kernel, trial)) break;
  }
  trial.fit.residual_sq = std::max(trial.fit.residual_sq, spread_sq);
}

/** Cauchy-like weights; their scale is the noise. */
void FinalFit::setRobustWeights(const LocalFit& fit) {
  const RadiusConstants& constants = trials_.constants();
  const double unit = trials_.samples().gatherRadius();
  residuals_.resize(robust_.count + BallBuffer::kPadding);
  kernels::ballResiduals(robust_, fit.degree, fit.c.data(), residuals_.data());
  const double scale_sq =
      constants.robust_scale * constants.robust_scale * trials_.noise() / (unit * unit);
  robust_.prior.assign(robust_.u.size(), 1.0f);
  for (std::size_t i = 0; i < robust_.count && scale_sq > 0; ++i) {
    const double q = 1.0 / (1.0 + residuals_[i] * residuals_[i] / scale_sq);
    robust_.prior[i] = static_cast<float>(q * q);
  }
}

RadiusSearch::RadiusSearch(const FitPlan& plan) : trials_(plan), tests_(trials_), final_(trials_) {
  if (plan.paper) {
    rule_ = std::make_unique<PaperRadiusRule>(trials_);
  } else {
    rule_ = std::make_unique<PenaltyRadiusRule>(trials_, tests_);
  }
}

RadiusSearch::~RadiusSearch() = default;

bool RadiusSearch::isNarrowest() const {
  const BallSamples& samples = trials_.samples();
  return kGolden * samples.rhoRight() * samples.gatherRadius() < trials_.plan().least_ball;
}

RadiusChoice RadiusSearch::notNarrower(const RadiusChoice& choice) {
  if (!(trials_.plan().least_ball > 0)) return choice;
  const bool internal = choice.kind == RadiusChoice::Kind::kInternal;
  if (internal ? !isNarrowest() : choice.kind != RadiusChoice::Kind::kLeaf) return choice;
  const BallSamples& samples = trials_.samples();
  const double least =
      std::min(trials_.plan().least_ball / samples.gatherRadius(), samples.rhoRight());
  if (!internal && choice.trial.rho >= least) return choice;
  const Trial trial = trials_.at(least);
  if (trial.supported) return RadiusChoice::leaf(trial);
  return internal ? RadiusChoice::leaf(trials_.right()) : choice;
}

RadiusChoice RadiusSearch::search() {
  return notNarrower(rule_->choose());
}

bool RadiusSearch::surelyInternal() {
  return !isNarrowest() && rule_->surelyInternal();
}

RadiusChoice RadiusSearch::fallBack() {
  return notNarrower(fallBackWhereSparse(trials_, tests_));
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius_search.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kWallSteps = 8;
constexpr double kWallMargin = 1.02;   ///< n_eff up to so many times the least support will do
constexpr double kWallLenience = 1.3;  ///< E at the wall rests on few degrees of freedom
constexpr double kWallAim = 1.01;
constexpr double kSure = 1.3;  ///< so much of E and e^2 a part of the points cannot be wrong
constexpr double kStructureSupport = 8.0;  ///< least supports that leave room for finer balls
constexpr double kStructureDeviations = 3.0;
constexpr double kStructureWorth = 0.5;  ///< penalties that shared variance must exceed
constexpr double kStructureCell = 3.0;   ///< sqrt(lambda): noise wears down what is finer
constexpr int kFeatureDegree = 2;
constexpr int kFeatureSteps = 4;         ///< radii tried for it ...
constexpr double kFeatureStep = 0.75;    ///< ... each so many times the last
constexpr double kFeatureSupport = 1.5;  ///< n_eff per coefficient asked of it
constexpr double kFeatureNoise = 1.15;   ///< e^2 above so many lambda is more than noise ...
constexpr double kFeatureHeight = 0.01;  ///< ... and e above this share of r is no smooth surface
constexpr double kFeatureGain = 0.9;     ///< of the risk that a lower degree must fall to
constexpr int kBrentSteps = 6;
constexpr int kLenientSteps = 2;
constexpr double kBrentWidth = 0.05;  ///< of log r: E is flat well beyond this

/** Abscissa of the minimum of the parabola through three points of (log rho, log E). */
double
parabolaMinimum(const Trial& a, const Trial& b, const Trial& c)
{
  const double xa = std::log(a.rho), xb = std::log(b.rho), xc = std::log(c.rho);
  const double fa = std::log(a.energy), fb = std::log(b.energy), fc = std::log(c.energy);
  const double p = (xb - xa) * (fb - fc), q = (xb - xc) * (fb - fa);
  const double denominator = p - q;
  const double x = std::abs(denominator) > 1e-300
                       ? xb - 0.5 * ((xb - xa) * p - (xb - xc) * q) / denominator
                       : xb;
  return std::exp(std::min(std::max(x, xa), xc));
}

RadiusChoice
leaf(const Trial& trial, bool forced = false)
{
  return {RadiusChoice::Kind::kLeaf, trial, forced, false};
}

RadiusChoice
internal(const Trial& right)
{
  return {RadiusChoice::Kind::kInternal, right, false, false};
}

}  // namespace

void
RadiusSearch::begin(const BallBuffer& ball, double gather_radius, double rho_right)
{
  ball_ = &ball;
  gather_radius_ = gather_radius;
  rho_right_ = rho_right;
  has_right_ = has_middle_ = has_inner_ = false;
}

/** The gathered points, or a smaller copy of them that still holds all within rho. */
const BallBuffer&
RadiusSearch::pointsWithin(double rho)
{
  const double middle = kGolden * rho_right_, inner = kGolden * middle;
  if (rho > middle) return *ball_;
  if (!has_middle_) {
    kernels::compactBall(*ball_, static_cast<float>(middle * middle), middle_);
    has_middle_ = true;
  }
  if (rho > inner) return middle_;
  if (!has_inner_) {
    kernels::compactBall(middle_, static_cast<float>(inner * inner), inner_);
    has_inner_ = true;
  }
  return inner_;
}

Trial
RadiusSearch::evaluate(double rho, int degree, WeightKernel kernel)
{
  ++fits_;
  Trial trial;
  trial.rho = rho;
  trial.fit = kernels::fitBall(pointsWithin(rho), degree, static_cast<float>(rho), kernel,
                               settings_.support, false);
  trial.supported = trial.fit.degree == degree;
  if (trial.supported) {
    trial.energy = energy_(trial.fit, rho * gather_radius_, gather_radius_);
  }
  return trial;
}

/** Smallest radius up to from at which n_eff still is the least support, to about 1 %. */
double
RadiusSearch::wallRadius(double from, int degree, WeightKernel kernel)
{
  const double target = settings_.support * numCoefficients(degree);
  double high = from, low = 0.0, rho = from;
  for (int step = 0; step < kWallSteps; ++step) {
    const double n_eff =
        kernels::effectiveCount(pointsWithin(rho), static_cast<float>(rho), kernel);
    if (n_eff >= target) {
      high = rho;
      if (n_eff <= kWallMargin * target) break;
    } else {
      low = rho;
    }
    // n_eff grows like r^2 on a surface; keep inside the bracket where it does not.
    const double guess = n_eff > 0 ? rho * std::sqrt(kWallAim * target / n_eff) : high;
    rho = guess > low && guess < high ? guess : 0.5 * (low + high);
  }
  return high;
}

/** The fit at minimum support. Bias rules there, so the flatter kernel is taken: it reaches the
 * same n_eff with a smaller ball. */
Trial
RadiusSearch::evaluateWall(double from)
{
  const double rho = wallRadius(from, settings_.degree, settings_.wall_kernel);
  return evaluate(rho, settings_.degree, settings_.wall_kernel);
}

bool
RadiusSearch::filledByNoise(double rho) const
{
  const double r = rho * gather_radius_;
  return r * r < energy_.thick * energy_.thick * energy_.lambda;
}

bool
RadiusSearch::lacksFit(const Trial& left, const Trial& middle, double margin) const
{
  if (settings_.lack_of_fit <= 0) return false;
  const double e_sq = std::min(variance(left), variance(middle));
  return e_sq > margin * settings_.lack_of_fit * settings_.lack_of_fit * energy_.lambda;
}

/** Where detail is finer than every radius tried, E does not fall towards smaller ones and looks
 * like that of noise; neighbouring residuals tell. Detail that weighs less than the penalty would
 * cost more noise to resolve than it is worth. */
bool
RadiusSearch::hidesStructure(const Trial& trial)
{
  if (!settings_.find_detail || lacksFit(trial, trial)) return false;
  const double terms = numCoefficients(trial.fit.degree);
  if (trial.fit.n_eff < kStructureSupport * settings_.support * terms) return false;
  const double inner = kGolden * trial.rho;
  const auto found = structure_.measure(pointsWithin(inner), trial.fit, inner,
                                        kStructureCell * std::sqrt(noise()) / gather_radius_);
  if (!(found.deviation > 0) || found.share < kStructureDeviations * found.deviation) return false;
  const double shared = found.share * trial.fit.residual_sq * gather_radius_ * gather_radius_;
  return shared > kStructureWorth * energy_.penalty(trial.fit, trial.rho * gather_radius_);
}

const Trial&
RadiusSearch::right()
{
  if (!has_right_) {
    right_ = evaluate(rho_right_, settings_.degree, settings_.fit_kernel);
  }
  has_right_ = true;
  return right_;
}

bool
RadiusSearch::besideFeature(const Trial& trial) const
{
  if (!settings_.find_detail || trial.fit.degree <= kFeatureDegree) return false;
  const double e_sq = variance(trial), r = trial.rho * gather_radius_;
  return e_sq > kFeatureHeight * kFeatureHeight * r * r && e_sq > kFeatureNoise * energy_.lambda;
}

/** Across an edge no degree fits, and a lower one needs less room: the quadratic in a smaller ball
 * that beats the trial by its expected error (kappa = 1: what is left is bias, not luck). */
Trial
RadiusSearch::lowDegree(const Trial& trial)
{
  Energy risk = energy_;
  risk.kappa = 1.0;
  const auto of = [&](const Trial& t) {
    return risk(t.fit, t.rho * gather_radius_, gather_radius_);
  };
  Trial best;
  double least = kFeatureGain * of(trial), rho = trial.rho;
  for (int step = 0; step < kFeatureSteps; ++step, rho *= kFeatureStep) {
    const Trial low = evaluate(rho, kFeatureDegree, settings_.fit_kernel);
    if (!low.supported || low.fit.n_eff < kFeatureSupport * numCoefficients(kFeatureDegree)) break;
    if (of(low) >= least) continue;
    best = low;
    least = of(low);
  }
  return best;
}

RadiusChoice
RadiusSearch::search()
{
  const RadiusChoice choice = chooseByEnergy();
  if (choice.kind == RadiusChoice::Kind::kLeaf && besideFeature(choice.trial)) {
    const Trial low = lowDegree(choice.trial);
    if (low.supported) return leaf(low);
  }
  if (choice.kind != RadiusChoice::Kind::kLeaf || choice.forced) return choice;
  if (!choice.plain && hidesStructure(choice.trial)) return internal(right());
  return leaf(leastDegree(choice.trial));
}

bool
RadiusSearch::surelyInternal()
{
  const Trial right = this->right();
  if (!right.supported) return false;
  const Trial middle = evaluate(kGolden * rho_right_);
  const Trial left = evaluate(kGolden * kGolden * rho_right_);
  if (!middle.supported || !left.supported) return false;
  if (lacksFit(left, middle, kSure)) return true;
  return kSure * left.energy < middle.energy && kSure * middle.energy < right.energy;
}

RadiusChoice
RadiusSearch::chooseByEnergy()
{
  const Trial right = this->right();
  if (!right.supported) return {RadiusChoice::Kind::kSparse, right, false};
  const Trial middle = evaluate(kGolden * rho_right_);
  if (!middle.supported) return chooseAtWall(right, right);
  const bool noise = !settings_.paper && isNoise(middle);
  if (noise && settings_.compare_nested) {
    const Trial wide = widestServing(middle, right);
    if (wide.supported) return {RadiusChoice::Kind::kLeaf, wide, false, true};
  } else if (noise && right.energy <= settings_.lenience * middle.energy) {
    return leaf(right);  // flat down to the noise: the largest radius serves
  }
  if (!settings_.paper && filledByNoise(kGolden * kGolden * rho_right_)) {
    return leaf(right.energy <= settings_.lenience * middle.energy ? right : middle);
  }
  const Trial left = evaluate(kGolden * kGolden * rho_right_);
  if (settings_.paper)
    return left.supported ? paperChoice(left, middle, right) : chooseAtWall(right, middle);
  if (!left.supported) return chooseAtWall(right, middle);
  if (lacksFit(left, middle)) return internal(right);
  return chooseInside(left, middle, right);
}

/** Support ends between the supported radii and the next one down: the last radius that has it
 * joins the comparison. */
RadiusChoice
RadiusSearch::chooseAtWall(const Trial& right, const Trial& middle)
{
  const Trial wall = evaluateWall(middle.rho);
  if (right.energy <= settings_.lenience * middle.energy &&
      (!wall.supported || right.energy <= kWallLenience * wall.energy)) {
    return leaf(right);
  }
  if (!wall.supported || middle.energy <= kWallLenience * wall.energy) return leaf(middle);
  return leaf(wall, true);
}

/** One parabolic step of Brent's method on a bracket a < b < c of a minimum near b. */
void
RadiusSearch::narrow(Trial& a, Trial& b, Trial& c)
{
  const Trial trial = evaluate(parabolaMinimum(a, b, c));
  if (!trial.supported || trial.rho == b.rho) return;
  if (trial.energy < b.energy) {
    (trial.rho < b.rho ? c : a) = b;
    b = trial;
  } else {
    (trial.rho < b.rho ? a : c) = trial;
  }
}

RadiusChoice
RadiusSearch::chooseInside(const Trial& left, const Trial& middle, const Trial& right)
{
  const Trial& least = left.energy < middle.energy ? left : middle;
  if (right.energy <= settings_.lenience * least.energy) return leaf(right);
  if (left.energy < middle.energy) return internal(right);
  // A minimum inside (rule 4, first half): two parabolic steps in log r, log E.
  Trial a = left, b = middle, c = right;
  narrow(a, b, c);
  if (settings_.lenience <= 1.0) {
    narrow(a, b, c);
    return leaf(b);
  }
  return leaf(largestLenient(b, right));
}

/** The largest radius up to right's with E <= lenience E_min: under noise E is flat, and its
 * argmin picks balls that are too small. */
Trial
RadiusSearch::largestLenient(const Trial& best, const Trial& right)
{
  const double limit = settings_.lenience * best.energy;
  if (right.energy <= limit) return right;
  Trial inside = best;
  double outside = right.rho;
  for (int step = 0; step < kLenientSteps; ++step) {
    const Trial trial = evaluate(std::sqrt(inside.rho * outside));
    if (trial.supported && trial.energy <= limit) {
      inside = trial;
    } else {
      outside = trial.rho;
    }
  }
  return inside;
}

/** Rule (4) with the clamp at r_r (E_l > E_m >= E_r), and Brent's parabolic steps. */
RadiusChoice
RadiusSearch::paperChoice(const Trial& left, const Trial& middle, const Trial& right)
{
  if (left.energy > middle.energy && middle.energy >= right.energy) return leaf(right);
  const bool bracketed = left.energy > middle.energy && middle.energy < right.energy;
  const bool monotone = left.fit.residual_sq < middle.fit.residual_sq &&
                        middle.fit.residual_sq < right.fit.residual_sq;
  if (!bracketed || !monotone) return internal(right);
  Trial a = left, b = middle, c = right;
  for (int step = 0; step < kBrentSteps && std::log(c.rho / a.rho) > kBrentWidth; ++step) {
    narrow(a, b, c);
  }
  return leaf(b);
}

}  // namespace pcl_slim::detail

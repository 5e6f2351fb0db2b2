// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

void BallSamples::begin(const BallBuffer& ball, double gather_radius, double rho_right) {
  ball_ = &ball;
  gather_radius_ = gather_radius;
  rho_right_ = rho_right;
  has_middle_ = has_inner_ = false;
}

const BallBuffer& BallSamples::within(double rho) {
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

void TrialFits::begin(const BallBuffer& ball, double gather_radius, double rho_right) {
  samples_.begin(ball, gather_radius, rho_right);
  has_right_ = false;
}

const Trial& TrialFits::right() {
  if (!has_right_) right_ = at(samples_.rhoRight());
  has_right_ = true;
  return right_;
}

Trial TrialFits::at(double rho, int degree, WeightKernel kernel) {
  ++counts_.fits;
  Trial trial;
  trial.rho = rho;
  trial.fit = kernels::fitBall(samples_.within(rho), degree, static_cast<float>(rho), kernel,
                               plan_.support, false);
  trial.supported = trial.fit.degree == degree;
  if (trial.supported) {
    trial.energy = energyOf(trial, energy_);
  } else {
    ++(trial.fit.fell_by_pivot ? counts_.fell_by_pivot : counts_.fell_by_support);
  }
  return trial;
}

double TrialFits::minimumSupportRadius(double from, int degree, WeightKernel kernel) {
  const double target = plan_.support * numCoefficients(degree);
  double high = from, low = 0.0, rho = from;
  for (int step = 0; step < constants().support_steps; ++step) {
    const double n_eff =
        kernels::effectiveCount(samples_.within(rho), static_cast<float>(rho), kernel);
    if (n_eff >= target) {
      high = rho;
      if (n_eff <= constants().support_margin * target) break;
    } else {
      low = rho;
    }
    // On a surface n_eff grows like r^2; where it does not, the bracket is halved.
    const double guess =
        n_eff > 0 ? rho * std::sqrt(constants().support_aim * target / n_eff) : high;
    rho = guess > low && guess < high ? guess : 0.5 * (low + high);
  }
  return high;
}

Trial TrialFits::atMinimumSupport(double from) {
  const double rho = minimumSupportRadius(from, plan_.degree, plan_.wall_kernel);
  return at(rho, plan_.degree, plan_.wall_kernel);
}

Trial TrialFits::ofLowerDegree(const Trial& trial, int degree) {
  // Slopes that are data have moments of their own, which are not kept.
  if (samples_.all().slope_weight > 0) return at(trial.rho, degree, plan_.fit_kernel);
  Trial low;
  low.rho = trial.rho;
  low.fit = nestedFit(trial.fit, degree);
  low.supported = low.fit.degree == degree;
  if (low.supported) low.energy = energyOf(low, energy_);
  return low;
}

bool TrialFits::refit(const BallBuffer& points, WeightKernel kernel, Trial& trial) {
  ++counts_.fits;
  const LocalFit fit = kernels::fitBall(points, trial.fit.degree, static_cast<float>(trial.rho),
                                        kernel, plan_.support, true);
  if (fit.degree != trial.fit.degree) {
    ++counts_.fell_by_pivot;
    return false;
  }
  counts_.least_pivot = std::min(counts_.least_pivot, fit.least_pivot);
  trial.fit = fit;
  return true;
}

namespace {

constexpr double kDiscPerSquare = 0.785;  ///< pi / 4: the area of a disc over that of its square

}  // namespace

/** The coefficients without what noise adds to them on average, which depends on the radius. */
std::array<double, kMaxCoefficients> FitComparison::unbiased(const Trial& trial) const {
  auto c = trial.fit.c;
  const double r = trials_.radiusOf(trial);
  undoNoiseBias(trials_.plan().constants.ball.bias, trial.fit.kernel, trial.fit.degree,
                trials_.noise() / (r * r), trial.rho, c.data());
  return c;
}

/** D^2 over the points of the closer fit, with its weights, from its moments. */
double FitComparison::meanSquaredDifference(const Trial& simpler, const Trial& close) const {
  auto difference = unbiased(simpler);
  const auto own = unbiased(close);
  for (std::size_t k = 0; k < own.size(); ++k) difference[k] -= own[k];
  const LocalFit& fit = close.fit;
  const double unit = trials_.samples().gatherRadius();
  return kernels::meanSquare(fit.moment_degree, fit.moments.data(), difference.data()) * unit *
         unit;
}

bool FitComparison::acceptsSimpler(const Trial& simpler, const Trial& close, double trust) const {
  const RadiusConstants& constants = trials_.constants();
  if (!(simpler.energy < constants.comparison_rise * close.energy)) return false;
  const double saved = close.fit.terms / close.fit.n_eff - simpler.fit.terms / simpler.fit.n_eff;
  // The rest of kappa insures against luck, of which there is little here.
  return meanSquaredDifference(simpler, close) < trust * constants.comparison_worth *
                                                     trials_.energy().kappa * trials_.noise() *
                                                     trials_.energy().correlation * saved;
}

Trial FitComparison::widestAccepted(const Trial& middle, const Trial& right) {
  const RadiusConstants& constants = trials_.constants();
  const bool flat = right.energy <= trials_.plan().lenience * middle.energy;
  const double trust = flat ? constants.comparison_trust : 1.0;
  if (acceptsSimpler(right, middle, trust) && !tests_.hidesDetail(right)) return right;
  const double step = std::pow(right.rho / middle.rho, 1.0 / constants.comparison_radii);
  Trial widest;
  double rho = middle.rho;
  for (int i = 1; i < constants.comparison_radii; ++i) {
    rho *= step;
    const Trial trial = trials_.at(rho);
    if (!trial.supported || !acceptsSimpler(trial, middle) || tests_.hidesDetail(trial)) break;
    widest = trial;
  }
  return widest;
}

Trial FitComparison::lowestDegreeAccepted(const Trial& trial) {
  const RadiusConstants& constants = trials_.constants();
  const bool enough = trial.fit.n_eff > constants.degree_support * trial.fit.terms;
  if (!trials_.plan().compare_nested || !enough || !tests_.isNoise(trial)) return trial;
  for (int degree = constants.least_degree; degree < trial.fit.degree; ++degree) {
    const Trial low = trials_.ofLowerDegree(trial, degree);
    if (low.supported && acceptsSimpler(low, trial)) return low;
  }
  return trial;
}

ResidualStructure::Finding ResidualStructure::measure(const BallBuffer& points, const LocalFit& fit,
                                                      double rho, double least_cell,
                                                      double correlation) {
  // Cells contain as many independent points as they would of white noise.
  const int side = cellsAlongSide(static_cast<double>(points.count) / correlation, rho, least_cell);
  if (side < constants_.least_cells) return {};
  residuals_.resize(points.count + BallBuffer::kPadding);
  kernels::ballResiduals(points, fit.degree, fit.c.data(), residuals_.data());
  const double squares = fillCells(points, rho, side);
  // Over ordered pairs of different points: the square of a cell's sum less the sum of its squares.
  double inside = 0, pairs = 0, products = -squares;
  for (const Cell& cell : cells_) {
    inside += cell.count;
    pairs += static_cast<double>(cell.count) * (cell.count - 1.0f);
    products += static_cast<double>(cell.sum) * cell.sum;
  }
  if (!(pairs > 0.0) || !(squares > 0.0)) return {};
  // A fit follows its points' noise, which leaves neighbouring residuals opposed.
  const double absorbed = constants_.absorbed_share * numCoefficients(fit.degree) / fit.n_eff;
  // Noise that neighbours share is common to that share of a cell's pairs.
  const double expected = (correlation - 1.0) * inside / pairs;
  return {products / pairs * inside / squares + absorbed - expected,
          correlation * std::sqrt(2.0 / pairs)};
}

/** The points' density decides, within limits. */
int ResidualStructure::cellsAlongSide(double points, double rho, double least_cell) const {
  const double squares_wanted = points / (kDiscPerSquare * constants_.points_per_cell);
  double cells = std::min(std::sqrt(squares_wanted), static_cast<double>(constants_.most_cells));
  if (least_cell > 0) cells = std::min(cells, 2.0 * rho / least_cell);
  return static_cast<int>(cells);
}

/** Sorts the residuals within rho into side times side cells. \return the sum of their squares. */
double ResidualStructure::fillCells(const BallBuffer& points, double rho, int side) {
  cells_.assign(static_cast<std::size_t>(side) * side, Cell{0.0f, 0.0f});
  const auto radius = static_cast<float>(rho);
  // A little less than half a side, so that rounding leaves the rim inside the last cell.
  const float limit_sq = radius * radius, per_length = 0.4999f * static_cast<float>(side) / radius;
  double squares = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (points.s_sq[i] >= limit_sq) continue;
    const int x = static_cast<int>((points.u[i] + radius) * per_length);
    const int y = static_cast<int>((points.v[i] + radius) * per_length);
    const float f = residuals_[i];
    Cell& cell = cells_[static_cast<std::size_t>(y * side + x)];
    cell.count += 1.0f;
    cell.sum += f;
    squares += f * f;
  }
  return squares;
}

bool ResidualTests::lacksFit(const Trial& left, const Trial& middle, double margin) const {
  const double limit = trials_.plan().lack_of_fit;
  if (limit <= 0) return false;
  const double e_sq = std::min(trials_.variance(left), trials_.variance(middle));
  return e_sq > margin * limit * limit * trials_.noise();
}

/** Where detail is finer than every radius tried, E does not fall towards smaller ones and looks
 * like that of noise; neighbouring residuals show it. Detail that weighs less than the penalty
 * would cost more noise to resolve than it is worth. */
bool ResidualTests::hidesDetail(const Trial& trial) {
  const FitPlan& plan = trials_.plan();
  const RadiusConstants& constants = trials_.constants();
  if (!plan.find_detail || lacksFit(trial)) return false;
  const double correlation = trials_.energy().correlation;
  const double terms = correlation * numCoefficients(trial.fit.degree);
  if (trial.fit.n_eff < constants.detail_support * plan.support * terms) return false;

  BallSamples& samples = trials_.samples();
  const double unit = samples.gatherRadius(), inner = kGolden * trial.rho;
  const double least_cell = constants.detail_cell * std::sqrt(trials_.noise()) / unit;
  const auto found =
      structure_.measure(samples.within(inner), trial.fit, inner, least_cell, correlation);
  if (!(found.deviation > 0)) return false;
  if (found.share < constants.detail_deviations * found.deviation) return false;
  const double shared = found.share * trial.fit.residual_sq * unit * unit;
  return shared >
         constants.detail_worth * trials_.energy().penalty(trial.fit, trials_.radiusOf(trial));
}

}  // namespace pcl_slim::detail

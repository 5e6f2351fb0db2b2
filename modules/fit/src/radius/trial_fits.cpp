// SPDX-License-Identifier: BSD-3-Clause
#include "radius/trial_fits.h"

#include <cmath>

#include "least_squares/local_fit.h"

namespace pcl_slim::detail {

void
BallSamples::begin(const BallBuffer& ball, double gather_radius, double rho_right)
{
  ball_ = &ball;
  gather_radius_ = gather_radius;
  rho_right_ = rho_right;
  has_middle_ = has_inner_ = false;
}

const BallBuffer&
BallSamples::within(double rho)
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

void
TrialFits::begin(const BallBuffer& ball, double gather_radius, double rho_right)
{
  samples_.begin(ball, gather_radius, rho_right);
  has_right_ = false;
}

const Trial&
TrialFits::right()
{
  if (!has_right_) right_ = at(samples_.rhoRight());
  has_right_ = true;
  return right_;
}

Trial
TrialFits::at(double rho, int degree, WeightKernel kernel)
{
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

double
TrialFits::minimumSupportRadius(double from, int degree, WeightKernel kernel)
{
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

Trial
TrialFits::atMinimumSupport(double from)
{
  const double rho = minimumSupportRadius(from, plan_.degree, plan_.wall_kernel);
  return at(rho, plan_.degree, plan_.wall_kernel);
}

Trial
TrialFits::ofLowerDegree(const Trial& trial, int degree)
{
  // Slopes that are data have moments of their own, which are not kept.
  if (samples_.all().slope_weight > 0) return at(trial.rho, degree, plan_.fit_kernel);
  Trial low;
  low.rho = trial.rho;
  low.fit = nestedFit(trial.fit, degree);
  low.supported = low.fit.degree == degree;
  if (low.supported) low.energy = energyOf(low, energy_);
  return low;
}

bool
TrialFits::refit(const BallBuffer& points, WeightKernel kernel, Trial& trial)
{
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

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/ball_samples.h"

#include "fit_settings.h"

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

}  // namespace pcl_slim::detail

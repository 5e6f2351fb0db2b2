// SPDX-License-Identifier: BSD-3-Clause
#include "ball/surfel_record.h"

#include <cmath>

#include "least_squares/noise_bias.h"
#include "pcl_slim/surface/oct_normal.h"

namespace pcl_slim::detail {

namespace {

/** Gives a linear surfel its plane's own normal: f is then w' - c_0, and only c_0 is left to store.
 */
void
framePlane(SurfelRecord& surfel)
{
  const LocalFrame frame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  const double c0 = surfel.c[0], cu = surfel.c[1], cv = surfel.c[2];
  const double length = std::sqrt(1.0 + cu * cu + cv * cv);
  std::array<double, 3> normal;
  for (int a = 0; a < 3; ++a) normal[a] = frame.w[a] - cu * frame.u[a] - cv * frame.v[a];
  surfel.normal = snapNormal(normal);
  surfel.c = {static_cast<float>(c0 / length)};
}

/** Coefficients in units of r from those in units of the gather radius: c_ij rho^(i + j - 1). */
void
setCoefficients(const Trial& trial, SurfelRecord& surfel)
{
  surfel.c.fill(0.0f);
  double factor = 1.0 / trial.rho;
  for (int d = 0, k = 0; d <= trial.fit.degree; ++d, factor *= trial.rho) {
    for (int j = 0; j <= d; ++j, ++k) surfel.c[k] = static_cast<float>(trial.fit.c[k] * factor);
  }
}

}  // namespace

SurfelRecord
recordOf(const FramedBall& ball, const RadiusChoice& choice, int level,
         const BiasConstants& constants)
{
  const Trial& trial = choice.trial;
  const double unit = ball.site.radius;
  SurfelRecord surfel;
  surfel.center = ball.site.center;
  surfel.normal = ball.normal;
  surfel.sided = ball.site.sided;
  surfel.radius = static_cast<float>(trial.rho * unit);
  surfel.error = static_cast<float>(std::sqrt(trial.fit.residual_sq) * unit);
  surfel.effective_count = static_cast<float>(trial.fit.n_eff);
  surfel.degree = static_cast<std::uint8_t>(trial.fit.degree);
  surfel.level = static_cast<std::uint8_t>(level);
  surfel.flags = choice.kind == RadiusChoice::Kind::kLeaf ? kSurfelLeaf : 0;
  if (choice.support_limited) surfel.flags |= kSurfelSupportLimited;
  setCoefficients(trial, surfel);
  const double share = ball.site.noise / (trial.rho * trial.rho * unit * unit);
  undoNoiseBias(constants, trial.fit.kernel, surfel.degree, share, surfel.c.data());
  if (surfel.degree == 1) framePlane(surfel);
  return surfel;
}

}  // namespace pcl_slim::detail

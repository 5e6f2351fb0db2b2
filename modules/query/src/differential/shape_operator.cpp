// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/detail/shape_operator.h"

#include <cmath>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

using Vector = std::array<double, 3>;

/** a^T H b for a symmetric matrix given as xx xy xz yy yz zz. */
double
form(const Vector& a, const double h[6], const Vector& b)
{
  return a[0] * (h[0] * b[0] + h[1] * b[1] + h[2] * b[2]) +
         a[1] * (h[1] * b[0] + h[3] * b[1] + h[4] * b[2]) +
         a[2] * (h[2] * b[0] + h[4] * b[1] + h[5] * b[2]);
}

std::array<float, 3>
turned(const LocalFrame& frame, double cosine, double sine)
{
  std::array<float, 3> direction;
  for (std::size_t a = 0; a < 3; ++a) {
    direction[a] = static_cast<float>(cosine * frame.u[a] + sine * frame.v[a]);
  }
  return direction;
}

}  // namespace

std::array<float, 2>
meanAndGaussian(const double g[3], double length, const double h[6])
{
  const double hg[3] = {h[0] * g[0] + h[1] * g[1] + h[2] * g[2],
                        h[1] * g[0] + h[3] * g[1] + h[4] * g[2],
                        h[2] * g[0] + h[4] * g[1] + h[5] * g[2]};
  const double ghg = g[0] * hg[0] + g[1] * hg[1] + g[2] * hg[2];
  const double length_sq = length * length;
  const double mean = (h[0] + h[3] + h[5] - ghg / length_sq) / (2 * length);
  const double adjugate[6] = {h[3] * h[5] - h[4] * h[4], h[2] * h[4] - h[1] * h[5],
                              h[1] * h[4] - h[2] * h[3], h[0] * h[5] - h[2] * h[2],
                              h[1] * h[2] - h[0] * h[4], h[0] * h[3] - h[1] * h[1]};
  const double gauss =
      g[0] * (adjugate[0] * g[0] + 2 * adjugate[1] * g[1] + 2 * adjugate[2] * g[2]) +
      g[1] * (adjugate[3] * g[1] + 2 * adjugate[4] * g[2]) + adjugate[5] * g[2] * g[2];
  return {static_cast<float>(mean), static_cast<float>(gauss / (length_sq * length_sq))};
}

PrincipalFrame
principalCurvatures(const double g[3], double length, const double h[6])
{
  // The shape operator is the Hessian over |g|, restricted to the tangent plane: two by two.
  const LocalFrame frame({g[0] / length, g[1] / length, g[2] / length});
  const double uu = form(frame.u, h, frame.u) / length;
  const double uv = form(frame.u, h, frame.v) / length;
  const double vv = form(frame.v, h, frame.v) / length;
  const double mean = 0.5 * (uu + vv), half = 0.5 * (uu - vv);
  const double spread = std::hypot(half, uv);
  const double angle = 0.5 * std::atan2(uv, half);
  PrincipalFrame principal;
  principal.k1 = static_cast<float>(mean + spread);
  principal.k2 = static_cast<float>(mean - spread);
  principal.direction1 = turned(frame, std::cos(angle), std::sin(angle));
  principal.direction2 = turned(frame, -std::sin(angle), std::cos(angle));
  return principal;
}

void
setExtremality(const double g[3], double length, const double h[6], const double third[10],
               PrincipalFrame& principal)
{
  const std::array<double, 3> n = {g[0] / length, g[1] / length, g[2] / length};
  const auto derivative = [&](const std::array<float, 3>& direction, double k) {
    const std::array<double, 3> t = {direction[0], direction[1], direction[2]};
    // How often each entry of the symmetric tensor stands in T(t, t, t).
    static constexpr double kCount[10] = {1, 3, 3, 3, 6, 3, 1, 3, 3, 1};
    double ttt = 0;
    for (int a = 0, i = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) {
        for (int c = b; c < 3; ++c, ++i) ttt += kCount[i] * third[i] * t[a] * t[b] * t[c];
      }
    }
    return static_cast<float>((ttt - 3 * k * form(t, h, n)) / length);
  };
  principal.extremality1 = derivative(principal.direction1, principal.k1);
  principal.extremality2 = derivative(principal.direction2, principal.k2);
}

}  // namespace pcl_slim::detail

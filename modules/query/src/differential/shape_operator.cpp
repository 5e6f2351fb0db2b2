// SPDX-License-Identifier: BSD-3-Clause
// Curvatures from a blended gradient and Hessian: theory.md, "Curvature"; equation (8), left.
#include "pcl_slim/query/detail/shape_operator.h"

#include <cmath>
#include <utility>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** a^T H b. */
double
form(const Vector3& a, const Symmetric3<double>& h, const Vector3& b)
{
  return dot(a, multiplied(h, b));
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

/** Cosine and sine of half the angle of (x, y), a vector of the given length; cosine >= 0. */
std::pair<double, double>
halfAngle(double x, double y, double length)
{
  double c = length + x, s = y;
  if (x < 0) c = std::abs(y), s = std::copysign(length - x, y);
  const double norm = std::sqrt(c * c + s * s);
  return norm > 0 ? std::make_pair(c / norm, s / norm) : std::make_pair(1.0, 0.0);
}

}  // namespace

std::array<float, 2>
meanAndGaussian(const Vector3& g, double length, const Symmetric3<double>& h)
{
  const double ghg = form(g, h, g);
  const double length_sq = length * length;
  const double mean = (h[kXX] + h[kYY] + h[kZZ] - ghg / length_sq) / (2 * length);
  const Symmetric3<double> adjugate = {
      h[kYY] * h[kZZ] - h[kYZ] * h[kYZ], h[kXZ] * h[kYZ] - h[kXY] * h[kZZ],
      h[kXY] * h[kYZ] - h[kXZ] * h[kYY], h[kXX] * h[kZZ] - h[kXZ] * h[kXZ],
      h[kXY] * h[kXZ] - h[kXX] * h[kYZ], h[kXX] * h[kYY] - h[kXY] * h[kXY]};
  const double gauss =
      g[0] * (adjugate[kXX] * g[0] + 2 * adjugate[kXY] * g[1] + 2 * adjugate[kXZ] * g[2]) +
      g[1] * (adjugate[kYY] * g[1] + 2 * adjugate[kYZ] * g[2]) + adjugate[kZZ] * g[2] * g[2];
  return {static_cast<float>(mean), static_cast<float>(gauss / (length_sq * length_sq))};
}

PrincipalFrame
principalCurvatures(const Vector3& g, double length, const Symmetric3<double>& h)
{
  // The shape operator is the Hessian over |g|, restricted to the tangent plane: two by two.
  const LocalFrame frame({g[0] / length, g[1] / length, g[2] / length});
  const double uu = form(frame.u, h, frame.u) / length;
  const double uv = form(frame.u, h, frame.v) / length;
  const double vv = form(frame.v, h, frame.v) / length;
  const double mean = 0.5 * (uu + vv), half = 0.5 * (uu - vv);
  const double spread = std::sqrt(half * half + uv * uv);
  const auto [cosine, sine] = halfAngle(half, uv, spread);
  PrincipalFrame principal;
  principal.k1 = static_cast<float>(mean + spread);
  principal.k2 = static_cast<float>(mean - spread);
  principal.direction1 = turned(frame, cosine, sine);
  principal.direction2 = turned(frame, -sine, cosine);
  return principal;
}

void
setExtremality(const Vector3& g, double length, const Symmetric3<double>& h, const double third[10],
               PrincipalFrame& principal)
{
  const Vector3 n = {g[0] / length, g[1] / length, g[2] / length};
  const auto derivative = [&](const std::array<float, 3>& direction, double k) {
    const Vector3 t = {direction[0], direction[1], direction[2]};
    // The multiplicity of each entry of the symmetric tensor in T(t, t, t).
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

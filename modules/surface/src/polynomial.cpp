// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/polynomial.h"

#include <cmath>

namespace pcl_slim {

LocalFrame::LocalFrame(const std::array<double, 3>& normal) : w(normal)
{
  const double sign = std::copysign(1.0, w[2]);
  const double a = -1.0 / (sign + w[2]);
  const double b = w[0] * w[1] * a;
  u = {1.0 + sign * w[0] * w[0] * a, sign * b, -sign * w[0]};
  v = {b, sign + w[1] * w[1] * a, -w[1]};
}

double
evaluateHeight(int degree, const float* c, double u, double v)
{
  double h = c[0] + c[1] * u + c[2] * v;
  if (degree >= 2) h += c[3] * u * u + c[4] * u * v + c[5] * v * v;
  if (degree >= 3) h += u * u * (c[6] * u + c[7] * v) + v * v * (c[8] * u + c[9] * v);
  if (degree >= 4) {
    h +=
        u * u * (u * (c[10] * u + c[11] * v) + c[12] * v * v) + v * v * v * (c[13] * u + c[14] * v);
  }
  return h;
}

namespace {

void
addCubic(const float* c, double u, double v, HeightJet& j)
{
  j.h += u * u * (c[6] * u + c[7] * v) + v * v * (c[8] * u + c[9] * v);
  j.hu += u * (3.0 * c[6] * u + 2.0 * c[7] * v) + c[8] * v * v;
  j.hv += c[7] * u * u + v * (2.0 * c[8] * u + 3.0 * c[9] * v);
  j.huu += 6.0 * c[6] * u + 2.0 * c[7] * v;
  j.huv += 2.0 * (c[7] * u + c[8] * v);
  j.hvv += 2.0 * c[8] * u + 6.0 * c[9] * v;
  j.huuu += 6.0 * c[6];
  j.huuv += 2.0 * c[7];
  j.huvv += 2.0 * c[8];
  j.hvvv += 6.0 * c[9];
}

void
addQuartic(const float* c, double u, double v, HeightJet& j)
{
  const double uu = u * u, uv = u * v, vv = v * v;
  j.h += uu * (c[10] * uu + c[11] * uv + c[12] * vv) + vv * (c[13] * uv + c[14] * vv);
  j.hu += 4.0 * c[10] * uu * u + 3.0 * c[11] * uu * v + 2.0 * c[12] * u * vv + c[13] * vv * v;
  j.hv += c[11] * uu * u + 2.0 * c[12] * uu * v + 3.0 * c[13] * u * vv + 4.0 * c[14] * vv * v;
  j.huu += 12.0 * c[10] * uu + 6.0 * c[11] * uv + 2.0 * c[12] * vv;
  j.huv += 3.0 * c[11] * uu + 4.0 * c[12] * uv + 3.0 * c[13] * vv;
  j.hvv += 2.0 * c[12] * uu + 6.0 * c[13] * uv + 12.0 * c[14] * vv;
  j.huuu += 24.0 * c[10] * u + 6.0 * c[11] * v;
  j.huuv += 6.0 * c[11] * u + 4.0 * c[12] * v;
  j.huvv += 4.0 * c[12] * u + 6.0 * c[13] * v;
  j.hvvv += 6.0 * c[13] * u + 24.0 * c[14] * v;
}

}  // namespace

HeightJet
evaluateJet(int degree, const float* c, double u, double v)
{
  HeightJet j;
  j.h = c[0] + c[1] * u + c[2] * v;
  j.hu = c[1];
  j.hv = c[2];
  if (degree >= 2) {
    j.h += c[3] * u * u + c[4] * u * v + c[5] * v * v;
    j.hu += 2.0 * c[3] * u + c[4] * v;
    j.hv += c[4] * u + 2.0 * c[5] * v;
    j.huu = 2.0 * c[3];
    j.huv = c[4];
    j.hvv = 2.0 * c[5];
  }
  if (degree >= 3) addCubic(c, u, v, j);
  if (degree >= 4) addQuartic(c, u, v, j);
  return j;
}

void
flipCoefficients(int degree, float* c)
{
  // The frame of -n is (u, -v, -w): h'(u, v) = -h(u, -v).
  int k = 0;
  for (int d = 0; d <= degree; ++d) {
    for (int power_of_v = 0; power_of_v <= d; ++power_of_v, ++k) {
      if (power_of_v % 2 == 0) c[k] = -c[k];
    }
  }
}

}  // namespace pcl_slim

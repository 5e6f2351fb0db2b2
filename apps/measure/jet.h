// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

namespace pcl_slim::measure {

/** \brief A number with its first and second derivatives by x, y, z: formulas give gradients and Hessians
 * by themselves. */
struct Jet {
  double value = 0;
  std::array<double, 3> g{};
  std::array<double, 6> h{};  ///< xx xy xz yy yz zz

  Jet() = default;
  Jet(double constant) : value(constant) {}

  /** \brief The coordinate along an axis. */
  static Jet variable(double value, std::size_t axis)
  {
    Jet jet(value);
    jet.g[axis] = 1.0;
    return jet;
  }
};

/** \brief f(a, b) from f and its derivatives there: fa fb faa fab fbb. */
inline Jet
applied(const Jet& a, const Jet& b, double f, const std::array<double, 5>& d)
{
  Jet r(f);
  for (std::size_t i = 0, k = 0; i < 3; ++i) {
    r.g[i] = d[0] * a.g[i] + d[1] * b.g[i];
    for (std::size_t j = i; j < 3; ++j, ++k) {
      r.h[k] = d[0] * a.h[k] + d[1] * b.h[k] + d[2] * a.g[i] * a.g[j] + d[4] * b.g[i] * b.g[j] +
               d[3] * (a.g[i] * b.g[j] + a.g[j] * b.g[i]);
    }
  }
  return r;
}

inline Jet
applied(const Jet& a, double f, double first, double second)
{
  return applied(a, Jet(), f, {first, 0, second, 0, 0});
}

inline Jet
operator+(const Jet& a, const Jet& b)
{
  return applied(a, b, a.value + b.value, {1, 1, 0, 0, 0});
}

inline Jet
operator-(const Jet& a, const Jet& b)
{
  return applied(a, b, a.value - b.value, {1, -1, 0, 0, 0});
}

inline Jet
operator*(const Jet& a, const Jet& b)
{
  return applied(a, b, a.value * b.value, {b.value, a.value, 0, 1, 0});
}

inline Jet
sin(const Jet& a)
{
  return applied(a, std::sin(a.value), std::cos(a.value), -std::sin(a.value));
}

inline Jet
cos(const Jet& a)
{
  return applied(a, std::cos(a.value), -std::sin(a.value), -std::cos(a.value));
}

inline Jet
pow(const Jet& a, double n)
{
  return applied(a, std::pow(a.value, n), n * std::pow(a.value, n - 1),
                 n * (n - 1) * std::pow(a.value, n - 2));
}

inline Jet
sqrt(const Jet& a)
{
  const double root = std::sqrt(a.value);
  return applied(a, root, 0.5 / root, -0.25 / (root * a.value));
}

inline Jet
atan2(const Jet& y, const Jet& x)
{
  const double s = x.value * x.value + y.value * y.value, s2 = s * s;
  const double xy = 2 * x.value * y.value, diff = y.value * y.value - x.value * x.value;
  return applied(y, x, std::atan2(y.value, x.value),
                 {x.value / s, -y.value / s, -xy / s2, diff / s2, xy / s2});
}

}  // namespace pcl_slim::measure

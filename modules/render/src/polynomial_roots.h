// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>

namespace pcl_slim {

/** \brief Real roots in ascending order. */
struct Roots {
  int count = 0;
  double at[4];

  void add(double x) { at[count++] = x; }
};

/** \brief a[0] + a[1] x + ... + a[Degree] x^Degree. */
template <int Degree>
inline double
evaluate(const double* a, double x)
{
  double value = a[Degree];
  for (int i = Degree - 1; i >= 0; --i) value = value * x + a[i];
  return value;
}

/** \brief The derivative of the same polynomial. */
template <int Degree>
inline double
evaluateDerivative(const double* a, double x)
{
  double value = Degree * a[Degree];
  for (int i = Degree - 1; i >= 1; --i) value = value * x + i * a[i];
  return value;
}

/** \brief The one root in [low, high], at whose ends the polynomial has opposite signs.
 *
 * Newton steps that leave the bracket or shrink it too slowly are replaced by bisection, so that
 * it converges whatever the polynomial.
 */
template <int Degree>
inline double
bracketedRoot(const double* a, double low, double high, double value_low, double value_high)
{
  constexpr double kTolerance = 1e-11;
  constexpr int kMaxSteps = 60;
  double x = low + (high - low) * (value_low / (value_low - value_high));
  for (int step = 0; step < kMaxSteps; ++step) {
    const double value = evaluate<Degree>(a, x);
    if ((value > 0.0) == (value_low > 0.0))
      low = x;
    else
      high = x;
    const double newton = value / evaluateDerivative<Degree>(a, x);
    if (std::abs(newton) <= kTolerance) break;
    double next = x - newton;
    const bool slow = step > 8 && (step & 1) == 0;
    if (!(next > low && next < high) || slow) next = 0.5 * (low + high);
    const bool settled = std::abs(next - x) <= kTolerance;
    x = next;
    if (settled) break;
  }
  return x;
}

/** \brief Both roots of a0 + a1 x + a2 x^2 without cancellation, those in [low, high] only. */
inline void
quadraticRoots(const double* a, double low, double high, Roots& roots)
{
  const double discriminant = a[1] * a[1] - 4.0 * a[2] * a[0];
  if (!(discriminant >= 0.0)) return;
  const double q = -0.5 * (a[1] + std::copysign(std::sqrt(discriminant), a[1]));
  double first = q != 0.0 ? a[0] / q : 0.0;
  double second = a[2] != 0.0 ? q / a[2] : HUGE_VAL;
  if (q == 0.0 && a[2] == 0.0) return;
  if (first > second) std::swap(first, second);
  if (first >= low && first <= high) roots.add(first);
  if (second != first && second >= low && second <= high) roots.add(second);
}

/** \brief True when the derivative's sign cannot change for |x| <= bound. */
template <int Degree>
inline bool
isMonotone(const double* a, double bound)
{
  double rest = 0.0, power = bound;
  for (int i = 2; i <= Degree; ++i, power *= bound) rest += i * std::abs(a[i]) * power;
  return std::abs(a[1]) > rest;
}

/** \brief Every root of the polynomial in [low, high], ascending.
 *
 * Between neighbouring roots of the derivative the polynomial is monotone and a sign change
 * brackets its one root; the derivative's roots are found the same way, down to a quadratic.
 */
template <int Degree>
inline void
rootsInInterval(const double* a, double low, double high, Roots& roots)
{
  if constexpr (Degree == 1) {
    const double x = -a[0] / a[1];
    if (x >= low && x <= high) roots.add(x);
  } else if constexpr (Degree == 2) {
    quadraticRoots(a, low, high, roots);
  } else {
    Roots turns;
    if (!isMonotone<Degree>(a, std::fmax(std::abs(low), std::abs(high)))) {
      double derivative[Degree];
      for (int i = 0; i < Degree; ++i) derivative[i] = (i + 1) * a[i + 1];
      rootsInInterval<Degree - 1>(derivative, low, high, turns);
    }
    double left = low, value_left = evaluate<Degree>(a, low);
    for (int i = 0; i <= turns.count; ++i) {
      const double right = i < turns.count ? turns.at[i] : high;
      const double value_right = evaluate<Degree>(a, right);
      if ((value_left > 0.0) != (value_right > 0.0)) {
        roots.add(bracketedRoot<Degree>(a, left, right, value_left, value_right));
      }
      left = right;
      value_left = value_right;
    }
  }
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Roots of polynomials of degree 1 to 4 in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcl_slim::detail {

/** \brief Real roots in ascending order. */
struct Roots {
  int count = 0;
  double at[4];

  void add(double x) { at[count++] = x; }
};

/** \brief a[0] + a[1] x + ... + a[Degree] x^Degree. */
template <int Degree>
inline double evaluate(const double* a, double x) {
  double value = a[Degree];
  for (int i = Degree - 1; i >= 0; --i) value = value * x + a[i];
  return value;
}

/** \brief The derivative of the same polynomial. */
template <int Degree>
inline double evaluateDerivative(const double* a, double x) {
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
inline double bracketedRoot(const double* a, double low, double high, double value_low,
                            double value_high) {
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
inline void quadraticRoots(const double* a, double low, double high, Roots& roots) {
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

/** \brief Bernstein coefficients of the polynomial over [low, high]; the first and last are its
 * values there. By Descartes' rule it has no more roots between than they have sign changes, and
 * differs from that number by an even one. */
template <int Degree>
inline void toBernstein(const double* a, double low, double high, double* b) {
  static_assert(Degree == 3 || Degree == 4);
  double c[Degree + 1];
  for (int i = 0; i <= Degree; ++i) c[i] = a[i];
  for (int i = 0; i < Degree; ++i) {
    for (int j = Degree - 1; j >= i; --j) c[j] += low * c[j + 1];
  }
  double power = 1.0;
  for (int i = 1; i <= Degree; ++i) c[i] *= power *= high - low;
  b[0] = c[0];
  if constexpr (Degree == 3) {
    b[1] = c[0] + c[1] / 3.0;
    b[2] = c[0] + (2.0 * c[1] + c[2]) / 3.0;
    b[3] = c[0] + c[1] + c[2] + c[3];
  } else {
    b[1] = c[0] + 0.25 * c[1];
    b[2] = c[0] + 0.5 * c[1] + c[2] / 6.0;
    b[3] = c[0] + 0.75 * c[1] + 0.5 * c[2] + 0.25 * c[3];
    b[4] = c[0] + c[1] + c[2] + c[3] + c[4];
  }
}

/** \brief Every root of the polynomial in [low, high], ascending.
 *
 * No or one sign change of the Bernstein coefficients settles most cases immediately. Otherwise:
 * between neighbouring roots of the derivative the polynomial is monotone and a sign change
 * brackets its one root; the derivative's roots are found the same way, down to a quadratic.
 */
template <int Degree>
inline void rootsInInterval(const double* a, double low, double high, Roots& roots) {
  if constexpr (Degree == 1) {
    const double x = -a[0] / a[1];
    if (x >= low && x <= high) roots.add(x);
  } else if constexpr (Degree == 2) {
    quadraticRoots(a, low, high, roots);
  } else {
    double b[Degree + 1];
    toBernstein<Degree>(a, low, high, b);
    int changes = 0;
    for (int i = 0; i < Degree; ++i) changes += (b[i] > 0.0) != (b[i + 1] > 0.0);
    if (changes == 0) return;
    if (changes == 1) {
      roots.add(bracketedRoot<Degree>(a, low, high, b[0], b[Degree]));
      return;
    }
    Roots turns;
    double derivative[Degree];
    for (int i = 0; i < Degree; ++i) derivative[i] = (i + 1) * a[i + 1];
    rootsInInterval<Degree - 1>(derivative, low, high, turns);
    double left = low, value_left = b[0];
    for (int i = 0; i <= turns.count; ++i) {
      const double right = i < turns.count ? turns.at[i] : high;
      const double value_right = i < turns.count ? evaluate<Degree>(a, right) : b[Degree];
      if ((value_left > 0.0) != (value_right > 0.0)) {
        roots.add(bracketedRoot<Degree>(a, left, right, value_left, value_right));
      }
      left = right;
      value_left = value_right;
    }
  }
}

/** \brief The same for a degree known at run time. \param[in] a five coefficients, those above the
 * degree 0 */
inline Roots rootsInInterval(int degree, const double* a, double low, double high) {
  Roots roots;
  switch (degree) {
    case 1: rootsInInterval<1>(a, low, high, roots); break;
    case 2: rootsInInterval<2>(a, low, high, roots); break;
    case 3: rootsInInterval<3>(a, low, high, roots); break;
    default: rootsInInterval<4>(a, low, high, roots); break;
  }
  return roots;
}

/** \brief The smallest root that counts: from low_front on if the polynomial falls there, from
 * low_behind on if it rises, and not beyond high. \return infinity if there is none.
 * \param[in] a as above \param[in] counts bool(root) */
template <typename Counts>
double firstRootInInterval(int degree, const double* a, double low_front, double low_behind,
                           double high, const Counts& counts) {
  const Roots roots = rootsInInterval(degree, a, std::min(low_front, low_behind), high);
  for (int i = 0; i < roots.count; ++i) {
    const bool falls = evaluateDerivative<4>(a, roots.at[i]) < 0.0;
    if (roots.at[i] >= (falls ? low_front : low_behind) && counts(roots.at[i])) return roots.at[i];
  }
  return HUGE_VAL;
}

/** \brief The root in [low, high] nearest to aim, of equals the first; with front_only of those at
 * which the polynomial falls. \return false if there is none. \param[in] a as above */
inline bool nearestRootInInterval(int degree, const double* a, double low, double high, double aim,
                                  bool front_only, double& root) {
  if (!(low <= high)) return false;
  const Roots roots = rootsInInterval(degree, a, low, high);
  double best = HUGE_VAL;
  for (int i = 0; i < roots.count; ++i) {
    if (front_only && !(evaluateDerivative<4>(a, roots.at[i]) < 0.0)) continue;
    const double distance = std::abs(roots.at[i] - aim);
    if (!(distance < best)) continue;
    best = distance;
    root = roots.at[i];
  }
  return best < HUGE_VAL;
}

/** \brief The root next to start where Newton's steps are sure to lead there and no other is
 * nearer. \return false when that cannot be decided cheaply.
 *
 * With d = 2 |p / p'| at start: if |p''| d < |p'| / 2 on [start - d, start + d], p is monotone
 * there and changes sign, so the interval contains exactly one root, and no other is as near.
 */
inline bool obviousRoot(const double* a, double start, double& root) {
  constexpr double kTolerance = 1e-11;
  const double value = evaluate<4>(a, start), slope = evaluateDerivative<4>(a, start);
  const double reach = 2.0 * std::abs(value);  // times 1 / |p'|
  const double steepness = std::abs(slope);
  if (!(reach < steepness)) return false;  // d < 1: the bound below stays sharp
  const double m = std::abs(start) + reach / steepness;
  const double bend = 2.0 * std::abs(a[2]) + m * (6.0 * std::abs(a[3]) + 12.0 * m * std::abs(a[4]));
  if (!(2.0 * bend * reach < steepness * steepness)) return false;
  double x = start - value / slope;
  for (int step = 0; step < 8; ++step) {
    const double shift = evaluate<4>(a, x) / evaluateDerivative<4>(a, x);
    x -= shift;
    if (std::abs(shift) <= kTolerance) break;
  }
  root = x;
  return true;
}

}  // namespace pcl_slim::detail

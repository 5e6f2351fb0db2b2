// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <type_traits>

#include "hwy/highway.h"
#include "pcl_slim/leaf/detail/line-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {
namespace {

using Coefficients = std::array<double, 15>;

/** w - h(u, v), monomial by monomial. */
double valueOf(int degree, const Coefficients& c, const Triple<double>& p) {
  double f = p.z;
  for (int n = 0, k = 0; n <= degree; ++n) {
    for (int j = 0; j <= n; ++j, ++k) f -= c[k] * std::pow(p.x, n - j) * std::pow(p.y, j);
  }
  return f;
}

/** How far f along random lines is from the polynomial of V. */
template <int D, class V>
double largestError() {
  std::mt19937 random(D);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] {
    return Triple<double>{uniform(random), uniform(random), uniform(random)};
  };
  const auto lanes = [](const Triple<double>& p) {
    return Triple<V>{number<V>(p.x), number<V>(p.y), number<V>(p.z)};
  };
  double error = 0.0;
  for (int i = 0; i < 500; ++i) {
    Coefficients c;
    for (double& value : c) value = uniform(random);
    const Triple<double> p = point(), d = point();
    const auto coefficient = [&](int k) HWY_ATTR { return number<V>(c[k]); };
    const LinePolynomial<D, V> line(coefficient, lanes(p), lanes(d));
    const double s = uniform(random), step = 1e-5, expected = valueOf(D, c, pointAt(p, s, d));
    const double slope =
        (valueOf(D, c, pointAt(p, s + step, d)) - valueOf(D, c, pointAt(p, s - step, d))) /
        (2 * step);
    const V value = line.value(number<V>(s)), rise = line.slope(number<V>(s));
    if constexpr (std::is_same_v<V, double>) {
      error = std::max({error, std::abs(value - expected), 1e-4 * std::abs(rise - slope)});
    } else {
      error =
          std::max({error, std::abs(GetLane(value) - expected), std::abs(GetLane(rise) - slope)});
    }
  }
  return error;
}

TEST(LinePolynomial, IsTheLeafAlongALine) {
  EXPECT_LT((largestError<1, double>()), 1e-12);
  EXPECT_LT((largestError<2, double>()), 1e-12);
  EXPECT_LT((largestError<3, double>()), 1e-12);
  EXPECT_LT((largestError<4, double>()), 1e-12);
}

TEST(LinePolynomial, IsTheSameInLanes) {
  using Vec = hn::Vec<hn::CappedTag<float, 8>>;
  EXPECT_LT((largestError<2, Vec>()), 2e-5);
  EXPECT_LT((largestError<3, Vec>()), 2e-5);
  EXPECT_LT((largestError<4, Vec>()), 2e-5);
}

}  // namespace
}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

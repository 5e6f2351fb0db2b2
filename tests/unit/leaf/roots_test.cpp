// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/leaf/detail/roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief Coefficients of the product of (x - root) over the given roots, times a factor. */
std::array<double, 5> fromRoots(const std::vector<double>& roots, double factor) {
  std::array<double, 5> a{factor, 0.0, 0.0, 0.0, 0.0};
  std::size_t degree = 0;
  for (const double root : roots) {
    ++degree;
    for (std::size_t i = degree; i > 0; --i) a[i] = a[i - 1] - root * a[i];
    a[0] *= -root;
  }
  return a;
}

TEST(PolynomialRoots, FindsEveryKnownRootInOrder) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int round = 0; round < 20000; ++round) {
    const std::size_t degree = round % 2 == 0 ? 3 : 4;
    std::vector<double> known(degree);
    for (double& root : known) root = uniform(random);
    std::sort(known.begin(), known.end());
    bool apart = true;
    for (std::size_t i = 0; i + 1 < degree; ++i) apart = apart && known[i + 1] - known[i] > 1e-3;
    if (!apart) continue;
    const auto a = fromRoots(known, uniform(random) > 0.0 ? 1.0 : -0.4);
    Roots found;
    if (degree == 3)
      rootsInInterval<3>(a.data(), -1.0, 1.0, found);
    else
      rootsInInterval<4>(a.data(), -1.0, 1.0, found);
    int expected = 0;
    for (const double root : known) {
      if (root <= -1.0 || root >= 1.0) continue;
      ASSERT_LT(expected, found.count);
      EXPECT_NEAR(found.at[expected++], root, 1e-6);
    }
    EXPECT_EQ(found.count, expected);
  }
}

TEST(PolynomialRoots, DegenerateCoefficientsGiveNoNonsense) {
  const double constant[5] = {1.0, 0.0, 0.0, 0.0, 0.0};
  const double line[5] = {-0.25, 0.5, 0.0, 0.0, 0.0};
  Roots none, one;
  rootsInInterval<1>(constant, -1.0, 1.0, none);
  rootsInInterval<2>(constant, -1.0, 1.0, none);
  rootsInInterval<3>(constant, -1.0, 1.0, none);
  rootsInInterval<4>(constant, -1.0, 1.0, none);
  EXPECT_EQ(none.count, 0);
  rootsInInterval<4>(line, -1.0, 1.0, one);
  ASSERT_EQ(one.count, 1);
  EXPECT_NEAR(one.at[0], 0.5, 1e-10);
  Roots vertex;  // both roots at 0
  const double parabola[5] = {0.0, 0.0, 2.0, 0.0, 0.0};
  rootsInInterval<2>(parabola, -1.0, 1.0, vertex);
  ASSERT_EQ(vertex.count, 1);
  EXPECT_EQ(vertex.at[0], 0.0);
}

TEST(PolynomialRoots, ObviousRootIsTheNearestOne) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int obvious = 0;
  for (int round = 0; round < 20000; ++round) {
    double a[5];
    for (double& c : a) c = uniform(random);
    a[0] *= 0.2;
    const double start = 0.5 * uniform(random);
    double root = 0.0;
    if (!obviousRoot(a, start, root)) continue;
    ++obvious;
    Roots all;
    rootsInInterval<4>(a, -3.0, 3.0, all);
    ASSERT_GT(all.count, 0);
    double nearest = all.at[0];
    for (int i = 1; i < all.count; ++i) {
      if (std::abs(all.at[i] - start) < std::abs(nearest - start)) nearest = all.at[i];
    }
    EXPECT_NEAR(root, nearest, 1e-8);
  }
  EXPECT_GT(obvious, 1000);
}

}  // namespace
}  // namespace pcl_slim

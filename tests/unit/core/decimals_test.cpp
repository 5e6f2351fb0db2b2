// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/decimals.h"

#include <gtest/gtest.h>

#include <limits>

namespace pcl_slim {
namespace {

TEST(DecimalsTest, FollowTheDiagonalNotThePlace) {
  EXPECT_EQ(decimalsFor(1.0), 5);
  EXPECT_EQ(decimalsFor(0.16), 6);   // a bunny in metres: a thousandth of a millimetre
  EXPECT_EQ(decimalsFor(160.0), 3);  // in millimetres
  EXPECT_EQ(decimalsFor(1000.0), 2);
  EXPECT_EQ(decimalsFor(1001.0), 2);
  EXPECT_EQ(decimalsFor(99999.0), 1);
  EXPECT_EQ(decimalsFor(1e5), 0);
  EXPECT_EQ(decimalsFor(1e9), 0);
  EXPECT_EQ(decimalsFor(1e-7), 12);
  // The northing of a scan of a kilometre, to the centimetre.
  EXPECT_EQ(fixedText(4500123.456, decimalsFor(1000.0)), "4500123.46");
}

TEST(DecimalsTest, OfNoDiagonal) {
  EXPECT_EQ(decimalsFor(0.0), 6);
  EXPECT_EQ(decimalsFor(-1.0), 6);
  EXPECT_EQ(decimalsFor(std::numeric_limits<double>::quiet_NaN()), 6);
  EXPECT_EQ(decimalsFor(std::numeric_limits<double>::infinity()), 6);
  EXPECT_EQ(decimalsFor(1e-305), 300);
}

TEST(DecimalsTest, ZeroHasNoSign) {
  EXPECT_EQ(fixedText(-0.0004, 2), "0.00");
  EXPECT_EQ(fixedText(-0.0, 0), "0");
  EXPECT_EQ(fixedText(-0.4, 1), "-0.4");
  EXPECT_EQ(fixedText(-10.0, 0), "-10");
}

TEST(DecimalsTest, TextIsAsLongAsItNeeds) {
  EXPECT_EQ(fixedText(1e300, 0).size(), 301u);
}

}  // namespace
}  // namespace pcl_slim

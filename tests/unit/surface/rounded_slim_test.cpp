// SPDX-License-Identifier: BSD-3-Clause
// A rounded .slim: how far it moves a surface, what stays exact, what damage is noticed.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "file/slim_file.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/surface_io.h"
#include "pcl_slim/surface/surfel_color.h"
#include "support/clouds.h"
#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

SLIMSurface roundTrip(const SLIMSurface& surface, double rounding) {
  const auto bytes = encodeSlim(surface, rounding);
  EXPECT_EQ(bytes[8], 5) << "the format's version";
  auto again = decodeSlim(bytes.data(), bytes.size());
  EXPECT_TRUE(again) << again.error().message;
  return again ? std::move(*again) : SLIMSurface();
}

Vector3 centerOf(const SLIMSurface& s, std::size_t i) {
  return {s.cx[i], s.cy[i], s.cz[i]};
}

LocalFrame frameOf(const SLIMSurface& s, std::size_t i) {
  return LocalFrame(normalized({s.nx[i], s.ny[i], s.nz[i]}));
}

/** The surfel of another surface with the nearest centre. */
std::size_t twinOf(const SLIMSurface& s, std::size_t i, const SLIMSurface& other) {
  std::size_t best = 0;
  double least = 1e30;
  for (std::size_t k = 0; k < other.size(); ++k) {
    const double d = length(subtract(centerOf(other, k), centerOf(s, i)));
    if (d < least) best = k;
    least = std::min(least, d);
  }
  return best;
}

/** Squared distance of two surfels along the normal, mean over the inner half of the disc. */
double squaredShift(const SLIMSurface& s, std::size_t i, const SLIMSurface& other, std::size_t k) {
  const LocalFrame frame = frameOf(s, i), turned = frameOf(other, k);
  double sum = 0.0;
  int count = 0;
  for (double u = -0.5; u <= 0.5; u += 0.125) {
    for (double v = -0.5; v <= 0.5; v += 0.125) {
      const double r = s.radius[i], h = evaluateHeight(s.degree[i], s.coefficientsOf(i), u, v);
      Vector3 p = along(along(centerOf(s, i), r * u, frame.u), r * v, frame.v);
      p = subtract(along(p, r * h, frame.w), centerOf(other, k));
      const double q = other.radius[k], hu = dot(p, turned.u) / q, hv = dot(p, turned.v) / q;
      const double height = evaluateHeight(other.degree[k], other.coefficientsOf(k), hu, hv);
      const double d = dot(p, turned.w) - q * height;
      sum += d * d;
      ++count;
    }
  }
  return sum / count;
}

/** Surfels as a fit makes them: flat against their balls, without jumps between neighbours. */
SLIMSurface flatSphere(int degree, std::size_t count) {
  SLIMSurface surface = sphereSurface(degree, count);
  for (float& c : surface.coefficients) c *= 0.2f;
  return surface;
}

double leafResidual(const SLIMSurface& s) {
  double sum = 0.0;
  for (const std::uint32_t i : s.leaves()) sum += double{s.error[i]} * s.error[i];
  return std::sqrt(sum / static_cast<double>(s.numLeaves()));
}

class RoundedSlim : public testing::TestWithParam<int> {};

TEST_P(RoundedSlim, MovesLeavesByTheShareOfTheirResidual) {
  const SLIMSurface surface = flatSphere(GetParam(), 400);
  double before = 1.0;
  for (const double rounding : {0.5, 0.1, 0.02}) {
    const SLIMSurface rounded = roundTrip(surface, rounding);
    ASSERT_EQ(rounded.size(), surface.size());
    EXPECT_EQ(rounded.numLeaves(), surface.numLeaves());
    double sum = 0.0;
    for (const std::uint32_t i : surface.leaves())
      sum += squaredShift(surface, i, rounded, twinOf(surface, i, rounded));
    const double shift = std::sqrt(sum / static_cast<double>(surface.numLeaves()));
    // Rounded to zero a little more often than evenly, over the inner disc alone.
    EXPECT_LT(shift, 1.3 * rounding * leafResidual(surface)) << rounding;
    EXPECT_GT(shift, 0.0);
    EXPECT_LT(shift, before);
    before = shift;
  }
}

TEST_P(RoundedSlim, TakesAFractionOfTheBytes) {
  const SLIMSurface surface = flatSphere(GetParam(), 2000);
  EXPECT_LT(3 * encodeSlim(surface, 0.5).size(), encodeSlim(surface).size());
  EXPECT_LT(encodeSlim(surface, 0.5).size(), encodeSlim(surface, 0.05).size());
}

INSTANTIATE_TEST_SUITE_P(Degrees, RoundedSlim, testing::Range(1, 5));

TEST(RoundedSlim, NeverMakesABallSmallerAndMovesItLittle) {
  const SLIMSurface surface = sphereSurface(4, 300);
  const SLIMSurface rounded = roundTrip(surface, 0.2);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::size_t k = twinOf(surface, i, rounded);
    EXPECT_GE(rounded.radius[k], surface.radius[i] * 0.999999f);
    EXPECT_LT(rounded.radius[k], surface.radius[i] * 1.03f);
    EXPECT_LT(length(subtract(centerOf(rounded, k), centerOf(surface, i))),
              0.03 * surface.radius[i]);
    EXPECT_EQ(rounded.level[k], surface.level[i]);
    EXPECT_EQ(rounded.degree[k], surface.degree[i]);
    EXPECT_NEAR(rounded.error[k], surface.error[i], 0.05f * surface.error[i]);
    EXPECT_NEAR(rounded.effective_count[k], surface.effective_count[i],
                0.1f * surface.effective_count[i]);
  }
  EXPECT_FALSE(rounded.children.empty()) << "links are rebuilt";
}

TEST(RoundedSlim, KeepsTrimMapsExactly) {
  SLIMSurface surface = flatSphere(3, 200);
  setRandomTrimMaps(surface);
  const SLIMSurface rounded = roundTrip(surface, 0.2);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TrimMap a = surface.trimMap(i), b = rounded.trimMap(twinOf(surface, i, rounded));
    ASSERT_EQ(a.side, b.side);
    for (int k = 0; k < a.side * a.side; ++k)
      ASSERT_EQ(a.at(k % a.side, k / a.side), b.at(k % a.side, k / a.side));
  }
}

TEST(RoundedSlim, KeepsColoursButForTheTurnOfTheirFrame) {
  SLIMSurface surface = flatSphere(4, 200);
  std::mt19937 random(3);
  for (std::size_t k = 0; k < surface.size() * kColorBytes; ++k) {
    const bool constant = k % kColorBytes < 3;
    surface.colors.push_back(static_cast<std::uint8_t>(constant ? random() % 256 : random() % 8));
  }
  const SLIMSurface rounded = roundTrip(surface, 0.2);
  ASSERT_TRUE(rounded.hasColors());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::size_t k = twinOf(surface, i, rounded);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(surface.colors[i * kColorBytes + c], rounded.colors[k * kColorBytes + c], 2);
  }
}

TEST(RoundedSlim, NumbersOutOfProportionStayFloats) {
  SLIMSurface surface = sphereSurface(2, 10);
  surface.coefficients[0] = 0x1p30f;
  surface.radius[0] = 0x1p20f;
  EXPECT_EQ(encodeSlim(surface, 1e-3), encodeSlim(surface));
  EXPECT_EQ(encodeSlim(SLIMSurface(), 0.1), encodeSlim(SLIMSurface()));
}

TEST(RoundedSlim, EveryFlippedBitAndEveryTruncationIsNoticed) {
  SLIMSurface surface = sphereSurface(2, 10);
  setRandomTrimMaps(surface);
  const auto bytes = encodeSlim(surface, 0.1);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= static_cast<unsigned char>(1u << (i % 8));
    EXPECT_FALSE(decodeSlim(damaged.data(), damaged.size())) << "byte " << i;
    EXPECT_FALSE(decodeSlim(bytes.data(), i)) << "length " << i;
  }
}

/** Damage behind a checksum that fits it: what a hostile file has. */
TEST(RoundedSlim, ForgedBytesGiveAnErrorOrAValidSurface) {
  SLIMSurface surface = sphereSurface(4, 60);
  setRandomTrimMaps(surface);
  const auto bytes = encodeSlim(surface, 0.1);
  std::mt19937 random(17);
  int refused = 0;
  constexpr int kFiles = 400;
  for (int file = 0; file < kFiles; ++file) {
    auto forged = bytes;
    const std::size_t first = file % 2 == 0 ? 136 : 150;
    for (int k = 0; k < 1 + file % 5; ++k)
      forged[first + random() % (forged.size() - first)] = static_cast<unsigned char>(random());
    if (file % 3 == 0) forged[32] = static_cast<unsigned char>(random());  // the number of surfels
    detail::sealSlim(forged);
    const auto read = decodeSlim(forged.data(), forged.size());
    if (read) {
      EXPECT_FALSE(read->validate());
    }
    refused += read ? 0 : 1;
  }
  EXPECT_GT(refused, kFiles / 2);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surfel_color.h"

#include <gtest/gtest.h>

#include "pcl_slim/surface/surface_io.h"
#include "support/colors.h"
#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** Red of a polynomial at (u, v). */
double redAt(const ColorPolynomial& color, double u, double v) {
  float c[kColorTerms];
  for (std::size_t k = 0; k < color.size(); ++k) c[k] = color[k][0];
  return evaluateHeight(kColorDegree, c, u, v);
}

TEST(SurfelColor, RoundsToItsStepAndClampsWhatIsOutOfRange) {
  ColorPolynomial color{};
  color[0] = {-3.0f, 99.6f, 400.0f};
  color[1] = {7.1f, -7.1f, 1e9f};
  color[5] = {-1e9f, 0.9f, -253.4f};
  std::uint8_t bytes[kColorBytes];
  encodeColor(color, bytes);
  const ColorPolynomial again = decodeColor(bytes);
  EXPECT_EQ(again[0], (std::array<float, 3>{0.0f, 100.0f, 255.0f}));
  EXPECT_EQ(again[1], (std::array<float, 3>{8.0f, -8.0f, 254.0f}));
  EXPECT_EQ(again[5], (std::array<float, 3>{-254.0f, 0.0f, -254.0f}));
  std::uint8_t twice[kColorBytes];
  encodeColor(again, twice);
  EXPECT_TRUE(std::equal(bytes, bytes + kColorBytes, twice));
}

TEST(SurfelColor, StaysInPlaceWhenItsSurfelIsTurnedRound) {
  SLIMSurface surface = sphereSurface(2, 20);
  setRandomColors(surface);
  const ColorPolynomial before = decodeColor(surface.colors.data());
  surface.flip(0);
  const ColorPolynomial after = decodeColor(surface.colors.data());
  for (const auto& [u, v] : {std::pair{0.3, 0.7}, {-0.4, 0.2}, {0.0, -1.0}})
    EXPECT_NEAR(redAt(before, u, v), redAt(after, u, -v), 1e-4);
  EXPECT_NE(redAt(before, 0.3, 0.7), redAt(after, 0.3, 0.7));
  surface.flip(0);
  EXPECT_EQ(decodeColor(surface.colors.data()), before);
}

TEST(SurfelColor, IsInFilesOfItsOwnVersion) {
  for (const bool open : {false, true}) {
    SLIMSurface surface = sphereSurface(3, 120);
    if (open) setRandomTrimMaps(surface);
    const auto plain = encodeSlim(surface);
    setRandomColors(surface);
    const auto bytes = encodeSlim(surface);
    EXPECT_EQ(plain[8], open ? 2 : 1) << "files without colours stay what older programs read";
    EXPECT_EQ(bytes[8], 4);
    EXPECT_EQ(bytes.size(), plain.size() + surface.size() * kColorBytes);
    const auto again = decodeSlim(bytes.data(), bytes.size());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->colors, surface.colors);
    EXPECT_EQ(again->trim_maps, surface.trim_maps);
    EXPECT_EQ(encodeSlim(*again), bytes);
  }
}

TEST(SurfelColor, GoesWithPartsAndTiles) {
  SLIMSurface surface = sphereSurface(2, 50);
  setRandomColors(surface);
  const SLIMSurface low = surface.slice(0, 20), high = surface.slice(20, 50);
  SLIMSurface joined;
  joined.append(low);
  joined.append(high);
  EXPECT_EQ(joined.colors, surface.colors);
  EXPECT_FALSE(joined.validate());
  SLIMSurface plain = high;
  plain.colors.clear();
  joined.append(plain);
  EXPECT_FALSE(joined.hasColors()) << "colours of some surfels are none of the surface";
  EXPECT_FALSE(joined.validate());
  surface.colors.pop_back();
  EXPECT_TRUE(surface.validate());
}

}  // namespace
}  // namespace pcl_slim

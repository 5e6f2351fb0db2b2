// SPDX-License-Identifier: BSD-3-Clause
// Textures of surfels in pages.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/web/page.h"
#include "pcl_slim/web/web_surface.h"
#include "support/colors.h"
#include "support/frame_difference.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/sphere_view.h"
#include "unit/web/web_decoder.h"

namespace pcl_slim {
namespace {

using namespace test;

SLIMSurface throughPage(const SLIMSurface& surface, double precision, int color_error) {
  const auto bytes = encodeWebSurface(surface, precision, color_error);
  EXPECT_TRUE(bytes) << bytes.error().message;
  auto web = decodeWebSurface(*bytes);
  EXPECT_TRUE(web) << web.error().message;
  return std::move(web->surface);
}

/** \brief Waves of a length of about .2, which textures of 24 texels a side follow. */
std::array<double, 3> waves(const std::array<double, 3>& p) {
  return pcl_slim_test::waveColor({16.0 * p[0], 16.0 * p[1], 4.0 * p[2]});
}

SLIMSurface wavySphere() {
  SLIMSurface sphere = sphereSurface(2, kSphere, 200, 0.08);
  pcl_slim_test::setRandomColors(sphere);
  pcl_slim_test::setTexturesOf(sphere, 24, waves);
  return sphere;
}

SLIMSurface randomSphere() {
  SLIMSurface sphere = sphereSurface(2, kSphere, 200, 0.08);
  pcl_slim_test::setRandomColors(sphere);
  pcl_slim_test::setRandomTextures(sphere);
  return sphere;
}

/** \brief Greatest difference of two textures on their discs; above 255 for other sides. */
float worstDifference(const SurfelTexture& a, const SurfelTexture& b) {
  if (a.side != b.side) return 256.0f;
  constexpr int kPlaces = 40;
  constexpr float kReach = SurfelTexture::kReach;
  float worst = 0.0f;
  for (int k = 0; k < kPlaces * kPlaces && a.side > 0; ++k) {
    const float u = kReach * (2.0f * static_cast<float>(k % kPlaces) / (kPlaces - 1) - 1.0f);
    const float v = kReach * (2.0f * static_cast<float>(k / kPlaces) / (kPlaces - 1) - 1.0f);
    if (u * u + v * v >= kReach * kReach) continue;
    const auto one = a.colorAt(u, v), other = b.colorAt(u, v);
    for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(one[c] - other[c]));
  }
  return worst;
}

TEST(WebTextures, DifferByNoMoreThanTheirError) {
  const SLIMSurface sphere = randomSphere();
  // In a page's order, in which surfels are compared.
  const SLIMSurface exact = throughPage(sphere, 0.0, 0);
  ASSERT_TRUE(exact.hasTextures());
  std::size_t same = 0;
  for (std::size_t i = 0; i < sphere.size(); ++i) {
    const auto at = std::find(exact.cx.begin(), exact.cx.end(), sphere.cx[i]) - exact.cx.begin();
    const auto k = static_cast<std::size_t>(at);
    ASSERT_LT(k, exact.size());
    same += worstDifference(sphere.texture(i), exact.texture(k)) == 0.0f;
  }
  EXPECT_EQ(same, sphere.size());
  for (const int error : {1, 2, 4, 32}) {
    const SLIMSurface rounded = throughPage(sphere, 0.0, error);
    float worst = 0.0f;
    for (std::size_t i = 0; i < exact.size(); ++i)
      worst = std::max(worst, worstDifference(exact.texture(i), rounded.texture(i)));
    // Of bilinear colours, in float.
    EXPECT_LE(worst, static_cast<float>(error) + 1e-3f);
    EXPECT_GT(worst, 0.9f * static_cast<float>(error));
  }
}

TEST(WebTextures, AreDrawnAsInPictures) {
  const SLIMSurface sphere = wavySphere();
  const Camera camera = frontCamera(80, 60);
  RenderParams params;
  params.columns |= kColorColumn;
  GBuffer truth, seen;
  ASSERT_FALSE(lab::renderReference(sphere, camera, params, truth));
  const SLIMSurface rounded = throughPage(sphere, PageParams().precision, PageParams().color_error);
  ASSERT_FALSE(lab::renderReference(rounded, camera, params, seen));
  std::vector<double> differences, from_waves;
  for (std::size_t i = 0; i < truth.numPixels(); ++i) {
    if (!truth.covered(i) || !seen.covered(i)) continue;
    const auto& p = seen.position[i];
    const auto wave = waves({p[0], p[1], p[2]});
    for (std::size_t c = 0; c < 3; ++c) {
      differences.push_back(255.0 * std::abs(seen.color[i][c] - truth.color[i][c]));
      from_waves.push_back(std::abs(255.0 * seen.color[i][c] - wave[c]));
    }
  }
  ASSERT_GT(differences.size(), 3000u);
  // Rounding by up to 2 adds to textures moved by less than a tenth of a texel: 1/150 of a wave.
  EXPECT_LT(percentile(differences, 0.5), 1.5);
  EXPECT_LT(percentile(differences, 0.99), 2.0 + 100.0 * 2.0 * M_PI / 150.0);
  EXPECT_LT(percentile(from_waves, 0.99), 12.0);
}

TEST(WebTextures, AreSmall) {
  const SLIMSurface sphere = wavySphere();
  SLIMSurface plain = sphere;
  plain.dropTextures();
  const auto without = encodeWebSurface(plain), unrounded = encodeWebSurface(plain, 896.0, 0);
  ASSERT_TRUE(without && unrounded);
  EXPECT_EQ(*without, *unrounded);  // of textures alone
  const auto bytesAt = [&](int color_error) {
    const auto bytes = encodeWebSurface(sphere, 896.0, color_error);
    EXPECT_TRUE(bytes);
    return static_cast<double>(bytes->size() - without->size());
  };
  const double texels = 24.0 * 24.0 * static_cast<double>(sphere.size());
  // Of three bytes: neighbours differ by up to 50, and from the prediction by a step or two.
  EXPECT_LT(bytesAt(0), 1.2 * texels);
  EXPECT_LT(bytesAt(2), 0.75 * texels);
  EXPECT_LT(bytesAt(4), bytesAt(2));
}

TEST(WebTextures, RefusesWhatCannotBe) {
  const SLIMSurface sphere = randomSphere();
  for (const int error : {-1, 33}) {
    EXPECT_EQ(encodeWebSurface(sphere, 896.0, error).error().code, ErrorCode::kBadArgument);
  }
}

}  // namespace
}  // namespace pcl_slim

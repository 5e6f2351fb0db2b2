// SPDX-License-Identifier: BSD-3-Clause
// What a page has of a surface, beside the surface itself.
#include "pcl_slim/web/web_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/web/page.h"
#include "support/clouds.h"
#include "support/colors.h"
#include "support/frame_difference.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/sphere_view.h"
#include "unit/web/web_decoder.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

SLIMSurface fittedSurface(Shape shape, int degree, std::size_t points = 15000,
                          double noise = 0.0005) {
  FitParams params;
  params.degree = degree;
  const auto cloud = pcl_slim_test::sceneCloud(shape, points, noise);
  return pcl_slim_test::fitted(cloud.withoutNormals(), params).surface;
}

WebSurface throughPage(const SLIMSurface& surface, double precision) {
  const auto bytes = encodeWebSurface(surface, precision);
  EXPECT_TRUE(bytes) << bytes.error().message;
  auto web = decodeWebSurface(*bytes);
  EXPECT_TRUE(web) << web.error().message;
  return std::move(*web);
}

/** \brief How a surface differs from the one that the camera frames, in double. */
FrameDifference difference(const SLIMSurface& seen, const SLIMSurface& truth) {
  RenderParams params;
  const Camera camera = fitCamera(spheresOf(truth), viewFromAngles(UpAxis::kZ, 30, 20), {160, 120});
  GBuffer buffers[2];
  EXPECT_FALSE(lab::renderReference(seen, camera, params, buffers[0]));
  EXPECT_FALSE(lab::renderReference(truth, camera, params, buffers[1]));
  return compareFrames(buffers[0], buffers[1], truth.info.diagonal);
}

TEST(WebSurface, WithoutRoundingIsTheSurface) {
  const SLIMSurface surface = fittedSurface(Shape::kRelief, 4);
  ASSERT_TRUE(surface.hasTrimMaps());
  const WebSurface web = throughPage(surface, 0.0);
  ASSERT_EQ(web.surface.size(), surface.size());
  EXPECT_EQ(web.surface.numLeaves(), surface.numLeaves());
  EXPECT_EQ(web.surface.info.oriented, surface.info.oriented);
  const auto d = difference(web.surface, surface);
  EXPECT_GT(d.both, 2000u);
  EXPECT_EQ(d.one, 0u);
  // Sums are taken in another order.
  EXPECT_LT(d.depth_p99, 1e-7);
  EXPECT_LT(d.normal_p99, 1e-4);
  EXPECT_EQ(d.leaves, 0u);
}

TEST(WebSurface, RoundedIsNearIt) {
  for (const Shape shape : {Shape::kBumpy, Shape::kRelief}) {
    for (const int degree : {1, 2, 3, 4}) {
      const SLIMSurface surface = fittedSurface(shape, degree);
      const WebSurface web = throughPage(surface, 640.0);
      const auto d = difference(web.surface, surface);
      EXPECT_GT(d.both, 2000u);
      EXPECT_LT(d.one, d.both / 1000 + 3) << degree;
      // A half step of each coefficient, blended over several leaves.
      EXPECT_LT(d.normal_p95, 0.06) << degree;
      // Steps of large balls are up to 1.6e-5 L, longer along rays that meet the surface obliquely.
      EXPECT_LT(d.depth_p99, 8e-5) << degree;
    }
  }
}

/** \brief A percentile of the differences of two surfaces' colours, of 255, where both are seen. */
double colorDifference(const SLIMSurface& seen, const SLIMSurface& truth, double share) {
  RenderParams params;
  const Camera camera = fitCamera(spheresOf(truth), viewFromAngles(UpAxis::kZ, 30, 20), {160, 120});
  GBuffer a, b;
  params.columns |= kColorColumn;
  EXPECT_FALSE(lab::renderReference(seen, camera, params, a));
  EXPECT_FALSE(lab::renderReference(truth, camera, params, b));
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.numPixels(); ++i) {
    for (std::size_t c = 0; c < 3 && a.covered(i) && b.covered(i); ++c)
      differences.push_back(255.0 * std::abs(a.color[i][c] - b.color[i][c]));
  }
  EXPECT_GT(differences.size(), 6000u);
  return percentile(differences, share);
}

TEST(WebSurface, HasTheSurfacesColours) {
  SLIMSurface surface = fittedSurface(Shape::kBumpy, 3);
  pcl_slim_test::setRandomColors(surface);  // at worst: from leaf to leaf anything
  EXPECT_LT(colorDifference(throughPage(surface, 0.0).surface, surface, 0.999), 0.01);
  // Terms are rounded to steps of 2 again, in frames turned by up to .03 degrees.
  const WebSurface rounded = throughPage(surface, PageParams().precision);
  EXPECT_LT(colorDifference(rounded.surface, surface, 0.5), 0.5);
  EXPECT_LT(colorDifference(rounded.surface, surface, 0.99), 3.0);
}

TEST(WebSurface, OfASphereIsTheSphere) {
  // Balls of a quarter of the sphere: steps per radius are as long as those of small balls.
  const WebSurface web = throughPage(sphereSurface(4, kSphere, 400, 0.06), 640.0);
  const Camera camera = frontCamera(80, 60);
  GBuffer buffer;
  ASSERT_FALSE(SurfaceRenderer(web.surface).render(camera, {}, buffer));
  const Deviation worst = compareWithSphere(buffer, camera, kSphere);
  EXPECT_EQ(worst.missed, 0u);
  EXPECT_LT(worst.depth, 3e-5);
  EXPECT_LT(worst.normal, 2e-3);
}

TEST(WebSurface, HasSizesForALevelOfDetail) {
  const SLIMSurface surface = fittedSurface(Shape::kBumpy, 2);
  const WebSurface web = throughPage(surface, 640.0);
  const detail::DetailSizes sizes(surface);
  auto expected = sizes.own, read = web.own;
  std::sort(expected.begin(), expected.end());
  std::sort(read.begin(), read.end());
  ASSERT_EQ(read.size(), expected.size());
  EXPECT_GT(expected.back(), 0.0f);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i], expected[i], 0.03f * expected[i]);  // a step of 8-bit logarithms
  }
  const auto orphans = [](const std::vector<float>& parents) {
    return std::count(parents.begin(), parents.end(), detail::DetailSizes::kNoParent);
  };
  EXPECT_EQ(orphans(web.parent), orphans(sizes.parent));
}

TEST(WebSurface, IsSmall) {
  const SLIMSurface surface = fittedSurface(Shape::kBumpy, 4, 40000, 0.0);
  const auto bytes = encodeWebSurface(surface);
  ASSERT_TRUE(bytes);
  // As text a third larger; a page may take 45 bytes a surfel.
  EXPECT_LT(static_cast<double>(bytes->size()), 33.0 * static_cast<double>(surface.size()));
  const auto again = encodeWebSurface(surface);
  EXPECT_EQ(*bytes, *again);
}

TEST(WebSurface, DamageIsFound) {
  SLIMSurface sphere = sphereSurface(2, kSphere, 100, 0.08);
  const auto bytes = encodeWebSurface(sphere);
  pcl_slim_test::setRandomColors(sphere);
  const auto colored = encodeWebSurface(sphere);
  ASSERT_TRUE(bytes && colored);
  pcl_slim_test::setRandomTextures(sphere);
  const auto textured = encodeWebSurface(sphere);
  ASSERT_TRUE(textured);
  for (const auto* whole : {&*bytes, &*colored, &*textured}) {
    for (std::size_t size = 0; size < whole->size(); size += 37)
      EXPECT_FALSE(
          decodeWebSurface({whole->begin(), whole->begin() + static_cast<std::ptrdiff_t>(size)}));
  }
  // Behind gzip's own header, whose time and system mean nothing.
  for (std::size_t at = 10; at < bytes->size(); at += 13) {
    auto damaged = *bytes;
    damaged[at] ^= 0x10;
    EXPECT_FALSE(decodeWebSurface(damaged)) << at;
  }
}

TEST(WebSurface, RefusesWhatCannotBe) {
  const SLIMSurface sphere = sphereSurface(2, kSphere, 100, 0.08);
  for (const double precision : {-1.0, 1.0, 1e9, std::nan("")}) {
    EXPECT_EQ(encodeWebSurface(sphere, precision).error().code, ErrorCode::kBadArgument);
  }
  SLIMSurface broken = sphere;
  broken.radius[3] = 0.0f;
  EXPECT_FALSE(encodeWebSurface(broken));
  const WebSurface none = throughPage(SLIMSurface(), 640.0);
  EXPECT_EQ(none.surface.size(), 0u);
}

}  // namespace
}  // namespace pcl_slim

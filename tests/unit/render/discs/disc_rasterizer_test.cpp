// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/disc_rasterizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_discs.h"
#include "unit/render/same_buffers.h"

namespace pcl_slim {
namespace {

using namespace test;

DiscRenderParams unfiltered() {
  DiscRenderParams params;
  params.filtered = false;
  return params;
}

GBuffer renderedDiscs(const SplatSet& set, const Camera& camera,
                      const DiscRenderParams& params = {},
                      DiscRenderStatistics* statistics = nullptr) {
  GBuffer buffer;
  const Error error = renderDiscs(set, camera, params, buffer, statistics);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

std::array<double, 3> bytesOf(std::uint32_t rgb) {
  return {double(rgb >> 16 & 255u), double(rgb >> 8 & 255u), double(rgb & 255u)};
}

double weightOf(double distance, double radius) {
  return std::pow(1.0 - distance * distance / (radius * radius), 2.0);
}

// A slanting disc in perspective is an exact conic: every pixel agrees with the ray that it stands
// for, but for those within float's rounding of the rim.
TEST(DiscRasterizer, OneDiscIsWhereRaysMeetIt) {
  SplatSet set;
  addDisc(set, {0.13, -0.07, 0.2}, {0.8, 0.3, 0.4}, 0.45, 0x4080c0);
  const Camera camera = discCamera(160, 120);
  const GBuffer buffer = renderedDiscs(set, camera, unfiltered());
  std::size_t covered = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      double depth = 0.0;
      const auto offset = planeHit(set, 0, camera, x, y, depth);
      const double share = std::sqrt(test::dotOf(offset, offset)) / 0.45;
      if (std::abs(share - 1.0) < 1e-5) continue;
      const std::size_t i = buffer.index(x, y);
      ASSERT_EQ(buffer.covered(i), share < 1.0) << x << " " << y;
      if (share > 1.0) continue;
      ++covered;
      ASSERT_NEAR(buffer.depth[i], depth, 1e-5);
      ASSERT_NEAR(buffer.color[i][1], 128.0 / 255.0, 1e-6);
      ASSERT_NEAR(buffer.normal[i][2], set.nz[0], 1e-6);
      for (std::size_t k = 0; k < 3; ++k) {
        const float center[3] = {set.x[0], set.y[0], set.z[0]};
        ASSERT_NEAR(buffer.position[i][k], center[k] + offset[k], 1e-5);
      }
    }
  }
  EXPECT_GT(covered, 500u);
  EXPECT_EQ(buffer.numCovered(), covered);
}

// A disc much smaller than a pixel, wherever it is between pixel centres, colours at least one
// and at most four; without the filter most such discs fall between the rays.
TEST(DiscRasterizer, FilterKeepsTinyDiscs) {
  const Camera camera = discCamera(40, 40);
  std::size_t lost = 0;
  for (int i = 0; i < 200; ++i) {
    SplatSet set;
    addDisc(set, {0.3 * std::sin(1.7 * i), 0.3 * std::cos(2.3 * i), 0.0}, {0.2, 0.1, 1.0}, 1e-4,
            0xff8000);
    const GBuffer buffer = renderedDiscs(set, camera);
    ASSERT_GE(buffer.numCovered(), 1u) << i;
    ASSERT_LE(buffer.numCovered(), 4u) << i;
    lost += renderedDiscs(set, camera, unfiltered()).numCovered() == 0;
  }
  EXPECT_GT(lost, 150u);
}

TEST(DiscRasterizer, FilterWidensDiscsByLessThanAPixel) {
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.3, 0xffffff);
  const Camera camera = discCamera(100, 100);
  const GBuffer sharp = renderedDiscs(set, camera, unfiltered()), soft = renderedDiscs(set, camera);
  EXPECT_EQ(sharp.numCovered(), soft.numCovered());
  // Seen along its side the disc has no width: the filter keeps its middle alone.
  SplatSet edge;
  addDisc(edge, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.3, 0xffffff);
  EXPECT_LE(renderedDiscs(edge, camera).numCovered(), 64u);
}

TEST(DiscRasterizer, OverlapIsTheWeightedMean) {
  SplatSet set;
  addDisc(set, {-0.1, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.3, 0xff0040);
  addDisc(set, {0.1, 0.05, 0.0}, {0.0, 0.0, -1.0}, 0.25, 0x20c0ff);
  const Camera camera = discCamera(120, 120);
  const GBuffer buffer = renderedDiscs(set, camera);
  std::size_t both = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      double weight = 0.0, color = 0.0, depth = 0.0;
      int met = 0;
      for (std::size_t i = 0; i < 2; ++i) {
        const auto offset = planeHit(set, i, camera, x, y, depth);
        const double distance = std::sqrt(test::dotOf(offset, offset));
        if (distance >= set.radius[i]) continue;
        ++met;
        weight += weightOf(distance, set.radius[i]);
        color += weightOf(distance, set.radius[i]) * bytesOf(set.rgb[i])[0];
      }
      if (met < 2) continue;
      ++both;
      const std::size_t i = buffer.index(x, y);
      ASSERT_NEAR(buffer.weight[i], weight, 1e-5);
      ASSERT_NEAR(buffer.color[i][0], color / weight / 255.0, 1e-5);
      // Both sides are drawn: the second disc's normal is turned round and adds to the first's.
      ASSERT_NEAR(buffer.normal[i][2], 1.0, 1e-6);
    }
  }
  EXPECT_GT(both, 300u);
}

TEST(DiscRasterizer, OneColorStaysThatColor) {
  SplatSet set = discSphere(0.5, 800, 0.06);
  for (auto& rgb : set.rgb) rgb = 0x3366cc;
  const GBuffer buffer = renderedDiscs(set, discCamera(90, 90));
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_NEAR(buffer.color[i][k], bytesOf(0x3366cc)[k] / 255.0, 1e-6);
    }
  }
}

TEST(DiscRasterizer, DiscsFartherBehindThanTheToleranceAreHidden) {
  const Camera camera = discCamera(100, 100);
  SplatSet front;
  addDisc(front, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.3, 0xff0000);
  const auto middleBlue = [&](double gap, bool behind_first) {
    SplatSet set;
    if (behind_first) addDisc(set, {0.0, 0.0, -gap}, {0.0, 0.0, 1.0}, 0.2, 0x0000ff);
    addDisc(set, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.3, 0xff0000);
    if (!behind_first) addDisc(set, {0.0, 0.0, -gap}, {0.0, 0.0, 1.0}, 0.2, 0x0000ff);
    const GBuffer buffer = renderedDiscs(set, camera);
    EXPECT_EQ(buffer.numCovered(), renderedDiscs(front, camera).numCovered());
    return buffer.color[buffer.index(50, 50)][2];
  };
  // Half the mean radius of .25, and half a pixel of .0146.
  const double tolerance =
      0.5 * (0.25 + 2.0 * 2.0 * std::tan(20.0 * std::acos(-1.0) / 180.0) / 100);
  for (const bool behind_first : {false, true}) {
    EXPECT_GT(middleBlue(0.95 * tolerance, behind_first), 0.4f);
    EXPECT_EQ(middleBlue(1.05 * tolerance, behind_first), 0.0f);
  }
}

// The tolerance is measured across the surface: along a slanting ray two discs of one plane may be far
// apart, and a wall's rim does not mix with the floor far behind.
TEST(DiscRasterizer, SlantingPlanesBlendAndWallsDoNot) {
  SplatSet floor;
  for (int i = -30; i <= 30; ++i) {
    for (int j = -30; j <= 30; ++j) {
      addDisc(floor, {0.04 * j, -0.1, 0.04 * i}, {0.0, 1.0, 0.0}, 0.06,
              (i + j) % 2 ? 0xffffff : 0x000000);
    }
  }
  Camera camera = discCamera(80, 80);
  const GBuffer plane = renderedDiscs(floor, camera);
  DiscRenderParams all;
  all.depth_tolerance = 100.0;
  EXPECT_EQ(plane.weight, renderedDiscs(floor, camera, all).weight);

  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.05}, 0.2, 0xff0000);
  addDisc(set, {0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, 1.0, 0x00ff00);
  const GBuffer wall = renderedDiscs(set, camera);
  std::size_t of_wall = 0;
  for (std::size_t i = 0; i < wall.numPixels(); ++i) {
    if (wall.surfel[i] != 0) continue;
    ++of_wall;
    ASSERT_EQ(wall.color[i][1], 0.0f);
  }
  EXPECT_GT(of_wall, 10u);
}

TEST(DiscRasterizer, GradientIsLinearAndClamped) {
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {0.2, 0.1, 1.0}, 0.4, 0x80f010);
  set.gradient.push_back({100, 0, 0, 0, 200, 0, 0, 0, 50});
  const Camera camera = discCamera(100, 100);
  const GBuffer buffer = renderedDiscs(set, camera, unfiltered());
  std::size_t clamped = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const std::size_t i = buffer.index(x, y);
      if (!buffer.covered(i)) continue;
      double depth = 0.0;
      const auto offset = planeHit(set, 0, camera, x, y, depth);
      const double green = 240.0 + 200.0 * offset[1];
      clamped += green > 255.0;
      ASSERT_NEAR(255.0 * buffer.color[i][0], 128.0 + 100.0 * offset[0], 1e-2);
      ASSERT_NEAR(255.0 * buffer.color[i][1], std::min(green, 255.0), 1e-2);
      ASSERT_NEAR(255.0 * buffer.color[i][2], 16.0 + 50.0 * offset[2], 1e-2);
    }
  }
  EXPECT_GT(clamped, 50u);
}

// Discs of radius q on a sphere touch it at their centres: depth is right within q^2 / 2R and a
// little more where discs are seen aslant.
TEST(DiscRasterizer, ASphereOfDiscsHasNoHoles) {
  const double q = 0.05, radius = 0.5;
  const GBuffer buffer = renderedDiscs(discSphere(radius, 2000, q), discCamera(120, 120));
  const Camera camera = discCamera(120, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const auto d = test::discRay(camera, x, y);
      const double b = 2.0 * d[2], aside_sq = 4.0 - b * b;
      const std::size_t i = buffer.index(x, y);
      if (aside_sq > (radius + q) * (radius + q)) {
        ASSERT_FALSE(buffer.covered(i));
      }
      if (aside_sq > 0.9 * radius * radius) continue;
      ASSERT_TRUE(buffer.covered(i)) << x << " " << y;
      const double depth = -b - std::sqrt(radius * radius - aside_sq);
      ASSERT_NEAR(buffer.depth[i], depth, 3.0 * q * q / radius);
    }
  }
}

TEST(DiscRasterizer, ThreadsAndSkippingChangeNothing) {
  const SplatSet set = discSphere(0.6, 3000, 0.05);
  for (const double distance : {2.0, 0.9, 40.0}) {
    Camera camera = discCamera(150, 110, 50.0);
    camera.position = {0.1, 0.2, distance};
    DiscRenderParams params;
    params.threads = 1;
    DiscRenderStatistics with, without;
    const GBuffer reference = renderedDiscs(set, camera, params, &with);
    for (const int threads : {2, 8}) {
      params.threads = threads;
      expectSame(reference, renderedDiscs(set, camera, params));
    }
    params.skip = false;
    expectSame(reference, renderedDiscs(set, camera, params, &without));
    EXPECT_EQ(with.blended, without.blended);
    EXPECT_LE(with.rays_blend, without.rays_blend);
  }
}

TEST(DiscRasterizer, SidesNearPlaneAndProjection) {
  const Camera camera = discCamera(80, 80);
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.5}, {0.0, 0.0, -1.0}, 0.2, 0xff0000);
  addDisc(set, {0.0, 0.0, -0.5}, {0.0, 0.0, 1.0}, 0.2, 0x00ff00);
  const std::size_t middle = 40 * 80 + 40;
  EXPECT_EQ(renderedDiscs(set, camera).surfel[middle], 0u);
  DiscRenderParams params;
  params.sides = VisibleSides::kFront;
  DiscRenderStatistics statistics;
  EXPECT_EQ(renderedDiscs(set, camera, params, &statistics).surfel[middle], 1u);
  EXPECT_EQ(statistics.back_facing, 1u);
  params = {};
  params.near_plane = 1.6;
  EXPECT_EQ(renderedDiscs(set, camera, params).surfel[middle], 1u);
  params.near_plane = 3.0;
  EXPECT_EQ(renderedDiscs(set, camera, params).numCovered(), 0u);
  Camera parallel = camera;
  parallel.projection = Camera::Projection::kOrthographic;
  parallel.view_height = 1.0;
  // A disc of radius .2 in a picture 1 high and 80 pixels: pi (16 pixels)^2.
  EXPECT_NEAR(static_cast<double>(renderedDiscs(set, parallel, unfiltered()).numCovered()), 804.0,
              20.0);
}

TEST(DiscRasterizer, BadInputIsNamed) {
  const Camera camera = discCamera(20, 20);
  GBuffer buffer;
  EXPECT_FALSE(renderDiscs(SplatSet(), camera, {}, buffer));
  EXPECT_EQ(buffer.numCovered(), 0u);
  SplatSet set;
  addDisc(set, {0, 0, 0}, {0, 0, 1}, 0.0, 0xff0000);  // one position: a point
  EXPECT_GE(renderedDiscs(set, camera).numCovered(), 1u);
  EXPECT_EQ(renderedDiscs(set, camera, unfiltered()).numCovered(), 0u);
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), -1.0f}) {
    SplatSet broken = set;
    broken.radius[0] = bad;
    EXPECT_TRUE(renderDiscs(broken, camera, {}, buffer));
    EXPECT_EQ(buffer.numPixels(), 0u);
  }
  SplatSet uneven = set;
  uneven.rgb.clear();
  EXPECT_TRUE(renderDiscs(uneven, camera, {}, buffer));
  DiscRenderParams params;
  params.depth_tolerance = -1.0;
  EXPECT_TRUE(renderDiscs(set, camera, params, buffer));
}

}  // namespace
}  // namespace pcl_slim

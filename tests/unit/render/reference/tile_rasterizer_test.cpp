// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/surface_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief Tolerances by degree from the Taylor remainder: ball radius .07, sphere radius .25. */
struct DegreeCase {
  int degree;
  double depth, normal, mean, gaussian;
};

class SphereOfDegree : public testing::TestWithParam<DegreeCase> {};

TEST_P(SphereOfDegree, MeetsTheAnalyticSphere) {
  const DegreeCase& p = GetParam();
  const SLIMSurface surface = sphereSurface(p.degree, kSphere, 600, 0.07);
  const Camera camera = frontCamera();
  const Deviation d = compareWithSphere(rendered(surface, camera), camera, kSphere);
  EXPECT_GT(d.covered, 800u);
  EXPECT_EQ(d.missed, 0u);
  EXPECT_EQ(d.extra, 0u);
  EXPECT_LT(d.depth, p.depth);
  EXPECT_LT(d.normal, p.normal);
  EXPECT_LT(d.mean, p.mean);
  EXPECT_LT(d.gaussian, p.gaussian);
}

INSTANTIATE_TEST_SUITE_P(Degrees, SphereOfDegree,
                         testing::Values(DegreeCase{1, 2e-2, 0.12, 1.01, 1.01},
                                         DegreeCase{2, 1e-3, 1e-2, 0.10, 0.20},
                                         DegreeCase{3, 1e-3, 1e-2, 0.10, 0.20},
                                         DegreeCase{4, 3e-5, 1e-3, 0.02, 0.04}));

TEST(TileRasterizer, RotatedOffsetAndScaledCameraSeesTheSameSphere) {
  SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07, {0.125, -0.25, 0.0625});
  surface.info.scale = 8.0;
  surface.info.origin = {-1.0, 2.0, -0.5};  // the sphere's centre becomes the world's origin
  Camera camera = frontCamera(97, 61);
  camera.position = {7.0, -4.0, 5.0};
  camera.up = {0.3, 1.0, 2.0};
  camera.fov = 34.0;
  const Deviation d = compareWithSphere(rendered(surface, camera), camera, 8.0 * kSphere, 8.0);
  EXPECT_GT(d.covered, 500u);
  EXPECT_EQ(d.missed + d.extra, 0u);
  EXPECT_LT(d.depth, 8.0 * 3e-5);
  EXPECT_LT(d.normal, 1e-3);
  EXPECT_LT(d.mean, 0.02);
}

TEST(TileRasterizer, ALeafThatDoesNotFitCountsByItsVariance) {
  constexpr float kRadius = 0.25f, kAbove = 0.01f;
  SLIMSurface surface;
  surface.info.degree = 1;
  surface.info.oriented = true;
  surface.info.diagonal = 1.0;
  surface.info.lambda = 1e-4;
  surface.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    surface.nz[i] = 1;
    surface.radius[i] = kRadius;
    surface.degree[i] = 1;
    surface.flags[i] = kSurfelLeaf;
  }
  surface.error = {0.01f, 0.05f};
  surface.coefficients[3] = kAbove / kRadius;
  const auto share = [&] {
    const Camera camera = frontCamera(81, 61);
    return (camera.position[2] - rendered(surface, camera).depth[30 * 81 + 40]) / kAbove;
  };
  // v / (v + e^2) with v = 1e-4: 1/2 and 1/26, but for (r / 1000)^2.
  EXPECT_NEAR(share(), 1.0 / 14.0, 0.01);
  surface.info.paper_mode = true;
  EXPECT_NEAR(share(), 0.5, 0.02);
}

TEST(TileRasterizer, OrthographicDepthIsThatOfParallelRays) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  Camera camera = frontCamera(64, 64);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.6;
  const GBuffer buffer = rendered(surface, camera);
  std::size_t compared = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double px = ((x + 0.5) / 64.0 - 0.5) * 0.6, py = (0.5 - (y + 0.5) / 64.0) * 0.6;
      const double rest = kSphere * kSphere * 0.92 - px * px - py * py;
      if (rest < 0.0) continue;
      const double z = std::sqrt(kSphere * kSphere - px * px - py * py);
      ASSERT_TRUE(buffer.covered(buffer.index(x, y)));
      EXPECT_NEAR(buffer.depth[buffer.index(x, y)], 1.2 - z, 3e-5);
      EXPECT_NEAR(buffer.position[buffer.index(x, y)][0], px, 1e-6);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1500u);
}

TEST(TileRasterizer, EmptySurfaceCoversNothing) {
  SLIMSurface surface;
  const GBuffer buffer = rendered(surface, frontCamera());
  EXPECT_EQ(buffer.numPixels(), 80u * 60u);
  EXPECT_EQ(buffer.numCovered(), 0u);
  EXPECT_EQ(buffer.depth[0], std::numeric_limits<float>::infinity());
}

TEST(TileRasterizer, InternalSurfelsAreNotDrawn) {
  SLIMSurface surface = sphereSurface(2, kSphere, 600, 0.07);
  for (std::uint8_t& flags : surface.flags) flags = 0;
  EXPECT_EQ(rendered(surface, frontCamera()).numCovered(), 0u);
}

TEST(TileRasterizer, FromInsideOnlyBothSidesShowAnOrientedSphere) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  Camera camera = frontCamera();
  camera.position = {0.0, 0.0, 0.0};
  camera.look_at = {1.0, 0.2, 0.0};
  EXPECT_EQ(rendered(surface, camera).numCovered(), 0u);

  RenderParams both;
  both.sides = VisibleSides::kBoth;
  const GBuffer buffer = rendered(surface, camera, both);
  ASSERT_EQ(buffer.numCovered(), buffer.numPixels());
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    EXPECT_NEAR(buffer.depth[i], kSphere, 3e-5);
    EXPECT_EQ(buffer.back_face[i], 1);
    EXPECT_NEAR(buffer.mean_curvature[i] * kSphere, -1.0, 0.02);  // hollow towards the viewer
  }
}

TEST(TileRasterizer, CameraInsideABallStaysFinite) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  Camera camera = frontCamera();
  camera.position = {0.0, 0.0, kSphere + 0.01};
  camera.fov = 100.0;
  const GBuffer buffer = rendered(surface, camera);
  EXPECT_GT(buffer.numCovered(), buffer.numPixels() / 4);
  const Deviation d = compareWithSphere(buffer, camera, kSphere);
  EXPECT_EQ(d.missed, 0u);
  EXPECT_LT(d.depth, 2e-4);
}

TEST(TileRasterizer, NearPlaneCutsTheFrontAway) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  RenderParams params;
  params.near_plane = 1.2;  // through the sphere's centre
  EXPECT_EQ(rendered(surface, frontCamera(), params).numCovered(), 0u);
  params.sides = VisibleSides::kBoth;
  const GBuffer buffer = rendered(surface, frontCamera(), params);
  const std::size_t middle = buffer.index(40, 30);
  ASSERT_TRUE(buffer.covered(middle));
  EXPECT_NEAR(buffer.depth[middle], 1.2 + kSphere, 1e-3);
}

TEST(TileRasterizer, UnorientedEqualsOrientedFromOutside) {
  const SLIMSurface oriented = sphereSurface(4, kSphere, 600, 0.07);
  SLIMSurface mixed = oriented;
  mixed.info.oriented = false;
  for (std::size_t i = 0; i < mixed.size(); i += 2) mixed.flip(i);
  const Camera camera = frontCamera();
  const GBuffer a = rendered(oriented, camera);
  const GBuffer b = rendered(mixed, camera);
  const Deviation d = compareWithSphere(b, camera, kSphere);
  EXPECT_EQ(d.missed + d.extra, 0u);
  EXPECT_LT(d.normal, 1e-3);
  EXPECT_LT(d.mean, 0.02);
  for (std::size_t i = 0; i < a.numPixels(); ++i) {
    if (!a.covered(i) || a.normal[i][2] < 0.3f) continue;
    ASSERT_TRUE(b.covered(i));
    EXPECT_NEAR(a.depth[i], b.depth[i], 1e-6);
    EXPECT_NEAR(a.mean_curvature[i], b.mean_curvature[i], 1e-4);
  }
}

TEST(TileRasterizer, NamesBadCamerasParametersAndSurfaces) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 10, 0.07);
  GBuffer buffer;
  Camera camera = frontCamera();
  camera.look_at = camera.position;
  EXPECT_EQ(renderSurface(surface, camera, {}, buffer).code, ErrorCode::kBadArgument);
  camera = frontCamera();
  camera.up = {0.0, 0.0, -3.0};
  EXPECT_EQ(renderSurface(surface, camera, {}, buffer).code, ErrorCode::kBadArgument);
  camera = frontCamera();
  camera.size = {0, 60};
  EXPECT_EQ(renderSurface(surface, camera, {}, buffer).code, ErrorCode::kBadArgument);
  camera = frontCamera();
  camera.position[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(renderSurface(surface, camera, {}, buffer).code, ErrorCode::kBadArgument);
  RenderParams params;
  params.shrink = 2.0;
  EXPECT_EQ(renderSurface(surface, frontCamera(), params, buffer).code, ErrorCode::kBadArgument);
  SLIMSurface broken = surface;
  broken.coefficients[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(renderSurface(broken, frontCamera(), {}, buffer).code, ErrorCode::kBadInput);
  EXPECT_EQ(buffer.numPixels(), 0u);
}

}  // namespace
}  // namespace pcl_slim

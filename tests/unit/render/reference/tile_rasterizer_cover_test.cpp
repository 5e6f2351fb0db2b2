// SPDX-License-Identifier: BSD-3-Clause
// Which leaves a ray meets: sheets behind, gaps, rims, and what is skipped.
#include <gtest/gtest.h>

#include <cmath>

#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

TEST(TileRasterizer, ASheetBehindDoesNotBleedThrough) {
  // Two spheres nested at a distance well below the balls' radius.
  SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const SLIMSurface inner = sphereSurface(4, kSphere - 0.03, 600, 0.07);
  const std::size_t n = surface.size();
  surface.resize(2 * n);
  for (auto column :
       {&SLIMSurface::cx, &SLIMSurface::cy, &SLIMSurface::cz, &SLIMSurface::radius,
        &SLIMSurface::nx, &SLIMSurface::ny, &SLIMSurface::nz, &SLIMSurface::coefficients}) {
    const auto& from = inner.*column;
    std::copy(from.begin(), from.end(),
              (surface.*column).end() - static_cast<std::ptrdiff_t>(from.size()));
  }
  for (std::size_t i = n; i < 2 * n; ++i) {
    surface.degree[i] = 4;
    surface.flags[i] = kSurfelLeaf;
  }
  const Camera camera = frontCamera();
  const Deviation d = compareWithSphere(rendered(surface, camera), camera, kSphere);
  EXPECT_EQ(d.missed, 0u);
  EXPECT_LT(d.depth, 3e-5);
}

/** \brief Planes at z = 0 on a square grid about the origin, radius .12, normals along z. */
SLIMSurface wallSurface(int side, double spacing) {
  SLIMSurface wall;
  wall.info.degree = 1;
  wall.info.oriented = true;
  wall.resize(static_cast<std::size_t>(side * side));
  for (int i = 0; i < side * side; ++i) {
    const auto s = static_cast<std::size_t>(i);
    wall.cx[s] = static_cast<float>(spacing * (i % side - 0.5 * (side - 1)));
    wall.cy[s] = static_cast<float>(spacing * (i / side - 0.5 * (side - 1)));
    wall.cz[s] = 0.0f;
    wall.radius[s] = 0.12f;
    wall.nx[s] = wall.ny[s] = 0.0f;
    wall.nz[s] = 1.0f;
    wall.degree[s] = 1;
    wall.flags[s] = kSurfelLeaf;
  }
  return wall;
}

/** \brief Looks along -z; 81 pixels of .005 a side, the middle one at the origin. */
Camera wallCamera() {
  Camera camera = frontCamera(81, 81);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.005 * 81;
  return camera;
}

/** Where (1 - s^2)^4 falls to gamma = .1: the covered middle of a ball of .12 shrunk by 2/3. */
const double kCoveredRadius = 0.08 * std::sqrt(1.0 - std::pow(0.1, 0.25));

TEST(TileRasterizer, RaysPassThroughWhatNoCoverSupports) {
  // One leaf's disc before a wall of many: beyond the disc's covered middle the wall is seen.
  SLIMSurface wall = wallSurface(13, 0.05);
  const std::size_t middle = wall.size() / 2;
  wall.cz[middle] = 0.3f;
  const GBuffer buffer = rendered(wall, wallCamera());
  for (int x = 0; x < 81; ++x) {
    const std::size_t pixel = buffer.index(x, 40);
    const double distance = std::abs(x - 40) * 0.005;
    if (std::abs(distance - kCoveredRadius) < 0.003) continue;
    ASSERT_TRUE(buffer.covered(pixel)) << x;
    EXPECT_NEAR(buffer.position[pixel][2], distance < kCoveredRadius ? 0.3 : 0.0, 1e-6) << x;
  }
  RenderParams all;
  all.min_coverage = 0.0;
  const GBuffer uncut = rendered(wall, wallCamera(), all);
  EXPECT_NEAR(uncut.position[uncut.index(40 + 15, 40)][2], 0.3, 1e-6);
}

TEST(TileRasterizer, RaysMeetASheetCloseBehindAWideFlap) {
  // The rim of a leaf ten times as wide passes .29 radii of the wall's leaves before them: too far
  // to blend there, while at the wall the flap's small weight takes part.
  SLIMSurface wall = wallSurface(13, 0.05);
  const std::size_t middle = wall.size() / 2;
  wall.cx[middle] = 0.68f;
  wall.cz[middle] = 0.035f;
  wall.radius[middle] = 1.2f;
  for (const bool reference : {false, true}) {
    const GBuffer buffer =
        reference ? referenceFrame(wall, wallCamera()) : rendered(wall, wallCamera());
    for (int x = 20; x <= 60; ++x) {
      const std::size_t pixel = buffer.index(x, 50);
      ASSERT_TRUE(buffer.covered(pixel)) << x;
      EXPECT_LT(buffer.position[pixel][2], 0.01) << x;
    }
  }
}

TEST(TileRasterizer, GapsBetweenLeavesAreFilledButRimsAreNot) {
  // Four leaves .1 apart: their middle is covered by .01 < gamma, yet they are all around it.
  const GBuffer buffer = rendered(wallSurface(2, 0.1), wallCamera());
  EXPECT_TRUE(buffer.covered(buffer.index(40, 40)));
  EXPECT_LT(buffer.coverage[buffer.index(40, 40)], 0.02f);
  // From the leaves' outer edge at x = .05 the wall goes on for the covered radius, no further.
  const int rim = static_cast<int>((0.05 + kCoveredRadius) / 0.005);
  EXPECT_TRUE(buffer.covered(buffer.index(40 + rim - 1, 50)));
  EXPECT_FALSE(buffer.covered(buffer.index(40 + rim + 2, 50)));
}

TEST(TileRasterizer, ThreadsAndSkippingDoNotChangeAByte) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const Camera camera = frontCamera(200, 150);
  RenderParams one;
  one.threads = 1;
  RenderStatistics skipped, plain;
  const GBuffer reference = rendered(surface, camera, one, &skipped);
  RenderParams four = one;
  four.threads = 4;
  expectSame(reference, rendered(surface, camera, four));
  RenderParams all = one;
  all.skip = false;
  expectSame(reference, rendered(surface, camera, all, &plain));
  EXPECT_GT(skipped.back_facing, surface.size() / 4);
  EXPECT_EQ(plain.back_facing, 0u);
  EXPECT_LT(skipped.tile_entries, plain.tile_entries);
  EXPECT_LE(skipped.rays_first, plain.rays_first);
  EXPECT_EQ(skipped.covered_pixels, reference.numCovered());
}

TEST(TileRasterizer, NoLeafOfAZoomedViewIsEvaluatedOutsideIt) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 5000, 0.025);
  Camera camera = frontCamera();
  camera.fov = 2.0;
  RenderStatistics counts;
  const GBuffer buffer = rendered(surface, camera, {}, &counts);
  EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
  EXPECT_GT(counts.outside_frustum + counts.back_facing, 4800u);
}

}  // namespace
}  // namespace pcl_slim

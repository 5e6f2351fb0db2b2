// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/tile_rasterizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_surfaces.h"

namespace pcl_slim {
namespace {

using test::sphereSurface;

constexpr double kSphere = 0.25;

Camera
frontCamera(int width = 80, int height = 60)
{
  Camera camera;
  camera.position = {0.0, 0.0, 1.2};
  camera.size = {width, height};
  return camera;
}

struct Deviation {
  std::size_t covered = 0, missed = 0, extra = 0;
  double depth = 0.0, normal = 0.0, mean = 0.0, gaussian = 0.0;
};

/** \brief Unit direction of a pixel's ray, computed here on its own. */
std::array<double, 3>
rayDirection(const Camera& c, int x, int y)
{
  const auto cross = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::array<double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0]};
  };
  const auto unit = [](std::array<double, 3> a) {
    const double l = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    return std::array<double, 3>{a[0] / l, a[1] / l, a[2] / l};
  };
  const auto f = unit(
      {c.look_at[0] - c.position[0], c.look_at[1] - c.position[1], c.look_at[2] - c.position[2]});
  const auto r = unit(cross(f, c.up)), u = cross(r, f);
  const double half = std::tan(c.fov * std::acos(-1.0) / 360.0);
  const double px = (2.0 * (x + 0.5) / c.size.width - 1.0) * half * c.size.width / c.size.height;
  const double py = (1.0 - 2.0 * (y + 0.5) / c.size.height) * half;
  return unit(
      {f[0] + px * r[0] + py * u[0], f[1] + px * r[1] + py * u[1], f[2] + px * r[2] + py * u[2]});
}

/** \brief Compares a buffer with the analytic sphere of world radius R about the world's origin.
 * Rays that pass within 4 % of the silhouette count as neither hit nor miss. */
Deviation
compareWithSphere(const GBuffer& buffer, const Camera& camera, double radius, double scale = 1.0)
{
  Deviation worst;
  const auto& o = camera.position;
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      const auto d = rayDirection(camera, x, y);
      const double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
      const double distance_sq = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - b * b;
      const double relative = std::sqrt(distance_sq) / radius;
      if (relative > 1.04) worst.extra += buffer.covered(i);
      if (relative > 0.96) continue;
      if (!buffer.covered(i)) {
        ++worst.missed;
        continue;
      }
      ++worst.covered;
      const double t = -b - std::sqrt(radius * radius - distance_sq);
      worst.depth = std::max(worst.depth, std::abs(buffer.depth[i] * scale - t));
      double cosine = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        cosine += buffer.normal[i][k] * (o[k] + t * d[k]) / radius;
      worst.normal = std::max(worst.normal, std::acos(std::min(1.0, cosine)));
      worst.mean = std::max(worst.mean, std::abs(buffer.mean_curvature[i] / scale * radius - 1.0));
      worst.gaussian =
          std::max(worst.gaussian,
                   std::abs(buffer.gaussian_curvature[i] / scale / scale * radius * radius - 1.0));
    }
  }
  return worst;
}

GBuffer
rendered(const SLIMSurface& surface, const Camera& camera, RenderParams params = {},
         RenderStatistics* statistics = nullptr)
{
  GBuffer buffer;
  const Error error = renderSurface(surface, camera, params, buffer, statistics);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

void
expectSame(const GBuffer& a, const GBuffer& b)
{
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.hessian, b.hessian);
  EXPECT_EQ(a.mean_curvature, b.mean_curvature);
  EXPECT_EQ(a.principal, b.principal);
  EXPECT_EQ(a.surfel, b.surfel);
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.coverage, b.coverage);
}

/** \brief Tolerances by degree from the Taylor remainder: ball radius .07, sphere radius .25. */
struct DegreeCase {
  int degree;
  double depth, normal, mean, gaussian;
};

class SphereOfDegree : public testing::TestWithParam<DegreeCase> {};

TEST_P(SphereOfDegree, MeetsTheAnalyticSphere)
{
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

TEST(TileRasterizer, RotatedOffsetAndScaledCameraSeesTheSameSphere)
{
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

TEST(TileRasterizer, OrthographicDepthIsThatOfParallelRays)
{
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

TEST(TileRasterizer, EmptySurfaceCoversNothing)
{
  SLIMSurface surface;
  const GBuffer buffer = rendered(surface, frontCamera());
  EXPECT_EQ(buffer.numPixels(), 80u * 60u);
  EXPECT_EQ(buffer.numCovered(), 0u);
  EXPECT_EQ(buffer.depth[0], std::numeric_limits<float>::infinity());
}

TEST(TileRasterizer, InternalSurfelsAreNotDrawn)
{
  SLIMSurface surface = sphereSurface(2, kSphere, 600, 0.07);
  for (std::uint8_t& flags : surface.flags) flags = 0;
  EXPECT_EQ(rendered(surface, frontCamera()).numCovered(), 0u);
}

TEST(TileRasterizer, FromInsideOnlyBothSidesShowAnOrientedSphere)
{
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

TEST(TileRasterizer, CameraInsideABallStaysFinite)
{
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

TEST(TileRasterizer, NearPlaneCutsTheFrontAway)
{
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

TEST(TileRasterizer, UnorientedEqualsOrientedFromOutside)
{
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

TEST(TileRasterizer, ASheetBehindDoesNotBleedThrough)
{
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
SLIMSurface
wallSurface(int side, double spacing)
{
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
Camera
wallCamera()
{
  Camera camera = frontCamera(81, 81);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.005 * 81;
  return camera;
}

/** Where (1 - s^2)^4 falls to gamma = .1: the covered middle of a ball of .12 shrunk by 2/3. */
const double kCoveredRadius = 0.08 * std::sqrt(1.0 - std::pow(0.1, 0.25));

TEST(TileRasterizer, RaysPassThroughWhatNoCoverSupports)
{
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

TEST(TileRasterizer, GapsBetweenLeavesAreFilledButRimsAreNot)
{
  // Four leaves .1 apart: their middle is covered by .01 < gamma, yet they lie all around it.
  const GBuffer buffer = rendered(wallSurface(2, 0.1), wallCamera());
  EXPECT_TRUE(buffer.covered(buffer.index(40, 40)));
  EXPECT_LT(buffer.coverage[buffer.index(40, 40)], 0.02f);
  // From the leaves' outer edge at x = .05 the wall goes on for the covered radius, no further.
  const int rim = static_cast<int>((0.05 + kCoveredRadius) / 0.005);
  EXPECT_TRUE(buffer.covered(buffer.index(40 + rim - 1, 50)));
  EXPECT_FALSE(buffer.covered(buffer.index(40 + rim + 2, 50)));
}

TEST(TileRasterizer, ThreadsAndSkippingDoNotChangeAByte)
{
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

TEST(TileRasterizer, NoLeafOfAZoomedViewIsEvaluatedOutsideIt)
{
  const SLIMSurface surface = sphereSurface(2, kSphere, 5000, 0.025);
  Camera camera = frontCamera();
  camera.fov = 2.0;
  RenderStatistics counts;
  const GBuffer buffer = rendered(surface, camera, {}, &counts);
  EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
  EXPECT_GT(counts.outside_frustum, 4800u);
}

TEST(TileRasterizer, NamesBadCamerasParametersAndSurfaces)
{
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

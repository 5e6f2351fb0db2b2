// SPDX-License-Identifier: BSD-3-Clause
// The rasteriser in single precision beside the one in double, and beside exact surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/auto_view.h"
#include "support/clouds.h"
#include "support/trim_maps.h"
#include "unit/render/sphere_view.h"
#include "unit/render/tracer/traced_scenes.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

/** \brief How two frames of one camera differ. */
struct Difference {
  std::size_t covered = 0, coverage = 0, far = 0;
  double depth_sq = 0.0, normal_sq = 0.0, mean_sq = 0.0, mean_size_sq = 0.0;

  Difference(const GBuffer& a, const GBuffer& b, double sheet) {
    for (std::size_t i = 0; i < a.numPixels(); ++i) {
      coverage += a.covered(i) != b.covered(i);
      if (!a.covered(i) || !b.covered(i)) continue;
      ++covered;
      const double d = double{a.depth[i]} - b.depth[i];
      if (std::abs(d) > sheet) {
        ++far;
        continue;
      }
      depth_sq += d * d;
      for (std::size_t k = 0; k < 3; ++k) {
        normal_sq += std::pow(double{a.normal[i][k]} - b.normal[i][k], 2);
      }
      mean_sq += std::pow(double{a.mean_curvature[i]} - b.mean_curvature[i], 2);
      mean_size_sq += std::pow(double{b.mean_curvature[i]}, 2);
    }
  }
  double rms(double sum) const { return std::sqrt(sum / static_cast<double>(covered)); }
};

SLIMSurface fittedScene(Shape shape, int degree, double noise, bool normals = true) {
  FitParams params;
  params.degree = degree;
  pcl_slim_test::Cloud cloud = pcl_slim_test::sceneCloud(shape, 12000, noise, 0.02);
  if (!normals) cloud.normals.clear();
  return pcl_slim_test::fitted(cloud, params).surface;
}

Camera viewOf(const SLIMSurface& surface, int width, int height) {
  const BoundingSpheres object = spheresOf(surface);
  return fitCamera(object, viewFromAngles(UpAxis::kZ, 25.0, 35.0), {width, height});
}

/** \brief A frame of each rasteriser. */
Difference difference(const SLIMSurface& surface, const Camera& camera,
                      const RenderParams& params = {}) {
  const GBuffer fast = rendered(surface, camera, params);
  const GBuffer reference = referenceFrame(surface, camera, params);
  return {fast, reference, 2e-3};
}

struct ModelCase {
  Shape shape;
  int degree;
  double noise;
  bool normals;
};

class FastAgainstReference : public testing::TestWithParam<ModelCase> {};

// Rounding is 1e-7 of the depth; leaves of weight below 1e-4 are left out; rays that pass within
// rounding of a rim or a threshold may fall to the other side.
TEST_P(FastAgainstReference, PicturesAgree) {
  const ModelCase& p = GetParam();
  const SLIMSurface surface = fittedScene(p.shape, p.degree, p.noise, p.normals);
  const Camera camera = viewOf(surface, 200, 150);
  const Difference d = difference(surface, camera);
  ASSERT_GT(d.covered, 6000u);
  EXPECT_LE(d.coverage, d.covered / 500);
  EXPECT_LE(d.far, d.covered / 1000);
  EXPECT_LT(d.rms(d.depth_sq), 5e-6);
  EXPECT_LT(d.rms(d.normal_sq), 1e-3);
  EXPECT_LT(d.mean_sq, 1e-4 * d.mean_size_sq + 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Models, FastAgainstReference,
                         testing::Values(ModelCase{Shape::kBumpy, 1, 0.0, true},
                                         ModelCase{Shape::kBumpy, 2, 0.0, true},
                                         ModelCase{Shape::kBumpy, 3, 0.001, true},
                                         ModelCase{Shape::kBumpy, 4, 0.0, true},
                                         ModelCase{Shape::kTorus, 4, 0.001, true},
                                         ModelCase{Shape::kRelief, 2, 0.001, true},
                                         ModelCase{Shape::kRelief, 4, 0.0, true},
                                         ModelCase{Shape::kTorus, 2, 0.0, false},
                                         ModelCase{Shape::kTorus, 4, 0.0, false}));

// Random maps have borders everywhere: rounding decides one pixel of a hundred beside them.
TEST_P(FastAgainstReference, TrimmedPicturesAgree) {
  const ModelCase& p = GetParam();
  SLIMSurface surface = fittedScene(p.shape, p.degree, p.noise, p.normals);
  surface.dropTrimMaps();
  const Camera camera = viewOf(surface, 200, 150);
  const std::size_t whole = rendered(surface, camera).numCovered();
  pcl_slim_test::setRandomTrimMaps(surface);
  const Difference d = difference(surface, camera);
  EXPECT_GT(d.covered, whole / 3);
  EXPECT_LT(d.covered, whole);
  EXPECT_LE(d.coverage + d.far, d.covered / 200);
  EXPECT_LT(d.rms(d.depth_sq), 5e-6);
  RenderParams untrimmed;
  untrimmed.trim = false;
  EXPECT_EQ(rendered(surface, camera, untrimmed).numCovered(), whole);
}

TEST(FastRasterizer, AgreesInParallelProjectionFromBehindAndWithANearPlane) {
  const SLIMSurface surface = fittedScene(Shape::kBumpy, 4, 0.0);
  const BoundingSpheres object = spheresOf(surface);
  const ViewDirection direction = viewFromAngles(UpAxis::kZ, 200.0, -20.0);
  const Camera parallel = fitOrthographicCamera(object, direction, {160, 120});
  for (const VisibleSides sides : {VisibleSides::kFront, VisibleSides::kBoth}) {
    RenderParams params;
    params.sides = sides;
    const Difference d = difference(surface, parallel, params);
    EXPECT_GT(d.covered, 4000u);
    EXPECT_LE(d.coverage + d.far, d.covered / 500);
    EXPECT_LT(d.rms(d.depth_sq), 5e-6);
    params.near_plane = 0.5 * surface.info.scale;
    const Difference cut = difference(surface, parallel, params);
    EXPECT_LE(cut.coverage + cut.far, cut.covered / 200 + 5);
  }
}

// Rays that look at one side of a box run along four others, and meet their leaves nowhere.
TEST(FastRasterizer, RaysAlongFlatLeavesGiveNumbers) {
  for (const int degree : {1, 2, 3, 4}) {
    SLIMSurface surface = emptySurface(degree);
    for (const double side : {-0.2, 0.2}) {
      const double n = side > 0.0 ? 1.0 : -1.0;
      addRectangle(surface, {side, -0.2, -0.2}, {0.0, 0.4, 0.0}, {0.0, 0.0, 0.4}, {n, 0.0, 0.0},
                   0.04, 0.08);
      addRectangle(surface, {-0.2, side, -0.2}, {0.4, 0.0, 0.0}, {0.0, 0.0, 0.4}, {0.0, n, 0.0},
                   0.04, 0.08);
      addRectangle(surface, {-0.2, -0.2, side}, {0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, {0.0, 0.0, n},
                   0.04, 0.08);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ViewDirection view{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
      view.towards_viewer[axis] = 1.0;
      view.up[(axis + 1) % 3] = 1.0;
      const Camera camera = fitOrthographicCamera(spheresOf(surface), view, {100, 100});
      for (const VisibleSides sides : {VisibleSides::kFront, VisibleSides::kBoth}) {
        RenderParams params;
        params.sides = sides;
        const Difference d = difference(surface, camera, params);
        EXPECT_GT(d.covered, 2000u);
        EXPECT_LE(d.coverage + d.far, d.covered / 100);
        EXPECT_LT(d.rms(d.normal_sq), 1e-4) << degree << " " << axis;
      }
    }
  }
}

// Leaves that face away may be what is in front.
TEST(FastRasterizer, DrawsBothSidesAlikeWhereSidesAreInDoubt) {
  SLIMSurface surface = sphereSurface(3, kSphere, 600, 0.07);
  Camera inside = frontCamera(64, 48);
  inside.position = {0.01, 0.02, 0.0};
  inside.look_at = {1.0, 0.2, 0.1};
  EXPECT_EQ(rendered(surface, inside, {}).numCovered(), 0u);
  surface.info.sides_in_doubt = true;
  const GBuffer buffer = rendered(surface, inside, {});
  EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
  EXPECT_EQ(std::count(buffer.back_face.begin(), buffer.back_face.end(), 1), 0);
  RenderParams front;
  front.sides = VisibleSides::kFront;
  EXPECT_EQ(rendered(surface, inside, front).numCovered(), 0u);
  EXPECT_LE(difference(surface, inside, {}).coverage, 5u);
}

TEST(FastRasterizer, AgreesNextToAndInsideTheModel) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  RenderParams both;
  both.sides = VisibleSides::kBoth;
  for (const double z : {0.26, 0.3, 0.24, 0.05, 0.0}) {
    Camera camera = frontCamera(64, 48);
    camera.position = {0.01, 0.02, z};
    camera.look_at = {0.02, 0.0, z < kSphere ? z + 1.0 : 0.0};
    camera.fov = 90.0;
    const Difference d = difference(surface, camera, both);
    EXPECT_LE(d.coverage + d.far, 20u) << z;
    EXPECT_LT(d.rms(d.depth_sq), 2e-5) << z;
  }
}

TEST(FastRasterizer, GrazingRaysAgree) {
  const SLIMSurface surface = fittedScene(Shape::kRelief, 4, 0.0);
  const BoundingSpheres object = spheresOf(surface);
  const Camera camera = fitCamera(object, viewFromAngles(UpAxis::kZ, 10.0, 4.0), {240, 80});
  const Difference d = difference(surface, camera);
  EXPECT_GT(d.covered, 1000u);
  EXPECT_LE(d.coverage + d.far, d.covered / 200 + 3);
}

TEST(FastRasterizer, TorusMeetsItsExactDepthNormalAndCurvature) {
  const SLIMSurface surface = fittedScene(Shape::kTorus, 4, 0.0);
  const Camera camera = viewOf(surface, 160, 120);
  const GBuffer buffer = rendered(surface, camera);
  const double scale = surface.info.scale;
  std::size_t count = 0;
  double position_sq = 0.0, normal_sq = 0.0, mean_sq = 0.0, mean_size_sq = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::size_t i = buffer.index(x, y);
      if (!buffer.covered(i)) continue;
      const auto ray = rayDirection(camera, x, y);
      std::array<double, 3> q;
      double cosine = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        q[k] = camera.position[k] + scale * buffer.depth[i] * ray[k];
        cosine += ray[k] * buffer.normal[i][k];
      }
      if (cosine > -0.2) continue;  // beside the outline a ray's error grows without bound
      const measure::Truth truth = measure::truthAt(Shape::kTorus, q);
      position_sq += truth.distance * truth.distance;
      normal_sq += std::pow(pcl_slim_test::angleBetween(buffer.normal[i], truth.normal), 2);
      const double mean = std::abs(buffer.mean_curvature[i]) / scale;
      mean_sq += std::pow(mean - std::abs(truth.mean_curvature), 2);
      mean_size_sq += std::pow(truth.mean_curvature, 2);
      ++count;
    }
  }
  // As the projection's: 12K clean points and quartics.
  ASSERT_GT(count, 4000u);
  EXPECT_LT(std::sqrt(position_sq / static_cast<double>(count)), 1e-4);
  EXPECT_LT(std::sqrt(normal_sq / static_cast<double>(count)), 2e-3);
  EXPECT_LT(mean_sq, 4e-4 * mean_size_sq);
}

TEST(FastRasterizer, ThreadsSkippingAndEarlierFramesDoNotChangeAByte) {
  const SLIMSurface surface = fittedScene(Shape::kBumpy, 4, 0.001);
  SurfaceRenderer renderer(surface);
  const Camera camera = viewOf(surface, 150, 110);
  RenderParams params;
  params.threads = 1;
  GBuffer first, again;
  ASSERT_FALSE(renderer.render(camera, params, first));
  for (const int threads : {2, 3, 1}) {
    for (const bool skip : {false, true}) {
      params.threads = threads;
      params.skip = skip;
      Camera other = camera;
      other.pixel_offset = {0.3, 0.4};
      other.size = {90, 70};
      ASSERT_FALSE(renderer.render(other, params, again));
      ASSERT_FALSE(renderer.render(camera, params, again));
      EXPECT_EQ(first.depth, again.depth);
      EXPECT_EQ(first.normal, again.normal);
      EXPECT_EQ(first.hessian, again.hessian);
      EXPECT_EQ(first.principal, again.principal);
      EXPECT_EQ(first.surfel, again.surfel);
      EXPECT_EQ(first.coverage, again.coverage);
    }
  }
}

TEST(FastRasterizer, ColumnsNotAskedForStayEmptyAndChangeNothing) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  RenderParams no_columns;
  no_columns.columns = 0;
  const GBuffer few = rendered(surface, frontCamera(), no_columns),
                all = rendered(surface, frontCamera());
  EXPECT_TRUE(few.position.empty() && few.hessian.empty() && few.weight.empty());
  EXPECT_EQ(few.depth, all.depth);
  EXPECT_EQ(few.normal, all.normal);
  EXPECT_EQ(few.surfel, all.surfel);
}

TEST(SurfaceRenderer, OneThatWasMovedFromSaysSo) {
  const SLIMSurface surface = fittedScene(Shape::kTorus, 2, 0.0);
  const Camera camera = viewOf(surface, 16, 12);
  SurfaceRenderer renderer(surface);
  SurfaceRenderer taken(std::move(renderer));
  GBuffer buffer;
  const Error error = renderer.render(camera, {}, buffer);  // NOLINT: on purpose
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
  EXPECT_NE(error.message.find("moved"), std::string::npos) << error.message;
  EXPECT_TRUE(renderer.surface().empty());
  EXPECT_FALSE(taken.render(camera, {}, buffer));
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Same input, same bytes: for any number of threads, in every mode.
#include <gtest/gtest.h>

#include <cstring>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

std::vector<unsigned char> fitBytes(const Cloud& cloud, FitParams params, int threads) {
  const PointStore store = pcl_slim_test::storeOf(cloud, threads);
  params.threads = threads;
  SLIMSurface surface;
  const Error error = fitSurface(store, params, surface);
  EXPECT_FALSE(error) << error.message;
  return encodeSlim(surface);
}

void expectSameBytes(const Cloud& cloud, const FitParams& params) {
  const auto one = fitBytes(cloud, params, 1);
  ASSERT_GT(one.size(), 1000u);
  for (const int threads : {1, 2, 8}) EXPECT_EQ(fitBytes(cloud, params, threads), one) << threads;
}

TEST(Determinism, OfTheDefault) {
  for (const double noise : {0.0, 0.002}) {
    const Cloud cloud = sceneCloud(Shape::kBumpy, 20000, noise, 0.1);
    expectSameBytes(cloud, {});
    expectSameBytes(cloud.withoutNormals(), {});
  }
}

TEST(Determinism, OfTheOtherModes) {
  const Cloud cloud = sceneCloud(Shape::kRelief, 8000, 0.0005, 0.1);
  FitParams robust, local, sharp, threshold, paper, compact;
  local.local_noise = true;
  robust.robust = true;
  sharp.sharp_features = true;
  threshold.size = MDLThreshold{0.005};
  paper.paper_mode = true;
  compact.cover_radius = 1.0;
  for (const FitParams& params : {robust, local, sharp, threshold, paper, compact}) {
    expectSameBytes(cloud, params);
    expectSameBytes(cloud.withoutNormals(), params);
  }
  FitParams data;
  data.normals_as_data = true;
  expectSameBytes(sceneCloud(Shape::kTorus, 20000, 0.003, 0.05), data);
}

TEST(Determinism, SeedsDiffer) {
  const Cloud cloud = sceneCloud(Shape::kTorus, 6000, 0.0005);
  FitParams one, two;
  two.seed = 2;
  EXPECT_NE(fitBytes(cloud, one, 1), fitBytes(cloud, two, 1));
}

TEST(Determinism, OfProjection) {
  auto f =
      pcl_slim_test::fitted(sceneCloud(Shape::kBumpy, 20000, 0.001).withoutNormals(), {}, true);
  ProjectionParams params;
  params.curvature = true;
  for (const int threads : {2, 8}) {
    params.threads = threads;
    Projection again;
    ASSERT_FALSE(projectPoints(f.store, f.surface, params, again));
    EXPECT_EQ(again.position, f.projection.position);
    EXPECT_EQ(again.normal, f.projection.normal);
    EXPECT_EQ(again.curvature, f.projection.curvature);
    EXPECT_EQ(again.supported, f.projection.supported);
  }
}

TEST(Determinism, SurvivesTheFile) {
  auto f = pcl_slim_test::fitted(sceneCloud(Shape::kTorus, 6000, 0.001));
  const auto bytes = encodeSlim(f.surface);
  const auto loaded = decodeSlim(bytes.data(), bytes.size());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->children, f.surface.children);
  Projection again;
  ProjectionParams params;
  ASSERT_FALSE(projectPoints(f.store, *loaded, params, again));
  EXPECT_EQ(again.position, f.projection.position);
  EXPECT_EQ(again.normal, f.projection.normal);
}

}  // namespace
}  // namespace pcl_slim

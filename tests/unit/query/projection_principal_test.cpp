// SPDX-License-Identifier: BSD-3-Clause
// Principal curvatures and directions, and surfaces met by points of another box.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

double dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return static_cast<double>(a[0]) * b[0] + static_cast<double>(a[1]) * b[1] +
         static_cast<double>(a[2]) * b[2];
}

Projection projected(const PointStore& store, const SLIMSurface& surface) {
  ProjectionParams params;
  params.directions = true;
  params.threads = 1;
  Projection projection;
  const Error error = projectPoints(store, surface, params, projection);
  EXPECT_FALSE(error) << error.message;
  return projection;
}

TEST(PrincipalFrame, AreTheRootsOfMeanAndGaussian) {
  const Fitted f = fitted(sceneCloud(Shape::kBumpy, 8000, 0.0));
  const Projection p = projected(f.store, f.surface);
  ASSERT_EQ(p.principal.size(), f.store.size());
  ASSERT_EQ(p.curvature.size(), f.store.size()) << "directions imply curvature";
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const PrincipalFrame& k = p.principal[i];
    ASSERT_GE(k.k1, k.k2);
    const double size = 1.0 + std::abs(k.k1) + std::abs(k.k2);
    ASSERT_NEAR(0.5 * (k.k1 + k.k2), p.curvature[i][0], 1e-5 * size);
    ASSERT_NEAR(static_cast<double>(k.k1) * k.k2, p.curvature[i][1], 1e-5 * size * size);
    ASSERT_NEAR(dot(k.direction1, k.direction1), 1.0, 1e-5);
    ASSERT_NEAR(dot(k.direction2, k.direction2), 1.0, 1e-5);
    ASSERT_NEAR(dot(k.direction1, k.direction2), 0.0, 1e-5);
    ASSERT_NEAR(dot(k.direction1, p.normal[i]), 0.0, 1e-5);
    ASSERT_NEAR(dot(k.direction2, p.normal[i]), 0.0, 1e-5);
  }
}

TEST(PrincipalFrame, OfASaddleLieAlongItsAxes) {
  // z = (x^2 - 3 y^2) / 4: at the middle -1/2 along x and 3/2 along y for the normal +z.
  Cloud cloud = heightField(6000, 3, [](double x, double y) { return (x * x - 3 * y * y) / 4; });
  FitParams params;
  params.viewpoint = {{0, 0, 50}};
  const Fitted f = fitted(cloud, params);
  const Projection p = projected(f.store, f.surface);
  std::size_t tested = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto at = f.world(p.position[i]);
    if (std::hypot(at[0], at[1]) > 0.02) continue;
    ++tested;
    EXPECT_GT(p.normal[i][2], 0.9f);
    EXPECT_NEAR(p.principal[i].k1 / f.store.scale(), 1.5, 0.02);
    EXPECT_NEAR(p.principal[i].k2 / f.store.scale(), -0.5, 0.02);
    EXPECT_GT(std::abs(p.principal[i].direction1[1]), 0.999f);
    EXPECT_GT(std::abs(p.principal[i].direction2[0]), 0.999f);
  }
  EXPECT_GT(tested, 0u);
}

TEST(Projection, ServesPartOfACloudAsTheWhole) {
  const Cloud whole = sceneCloud(Shape::kTorus, 20000, 0.001);
  const Fitted f = fitted(whole);
  Cloud part;  // a corner: another box, hence another origin and scale
  std::vector<std::size_t> source;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const double* p = whole.points.data() + 3 * i;
    if (p[0] < 0.9 || p[1] < 0.0) continue;
    part.add(p[0], p[1], p[2]);
    source.push_back(i);
  }
  ASSERT_GT(part.size(), 100u);
  const PointStore store = storeOf(part);
  ASSERT_NE(store.scale(), f.store.scale());
  const Projection p = projected(store, f.surface);
  const auto all_of_whole = f.store.storeOfInput();
  for (std::size_t i = 0; i < store.size(); ++i) {
    const std::size_t j = all_of_whole[source[store.orderOfStore()[i]]];
    ASSERT_EQ(p.supported[i], f.projection.supported[j]);
    const auto expected = f.world(f.projection.position[j]);
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_NEAR(store.origin()[a] + store.scale() * p.position[i][a], expected[a], 1e-6);
    }
    ASSERT_GT(dot(p.normal[i], f.projection.normal[j]), 1.0 - 1e-5);
  }
}

TEST(Projection, LeavesPointsElsewhereAlone) {
  const Fitted f = fitted(sceneCloud(Shape::kSphere, 2000, 0.0));
  Cloud elsewhere = sceneCloud(Shape::kSphere, 500, 0.0);
  for (double& value : elsewhere.points) value = 40.0 + 0.5 * value;
  const PointStore store = storeOf(elsewhere);
  const Projection p = projected(store, f.surface);
  EXPECT_EQ(p.num_unsupported, store.size());
  for (std::size_t i = 0; i < store.size(); ++i) ASSERT_EQ(p.position[i], store.position(i));
}

}  // namespace
}  // namespace pcl_slim

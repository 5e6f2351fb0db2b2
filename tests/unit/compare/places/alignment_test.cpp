// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/alignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/compare/carrier_mesh.h"

namespace pcl_slim {
namespace {

/** An open wavy sheet over [-1, 1]^2 that faces up, of n x n cells. */
TriangleMesh sheet(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      mesh.vertices.push_back({x, y, 0.2 * std::sin(3 * x) * std::cos(2 * y) + 0.1 * x * y});
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/** Its vertices as places. */
PlaceColumns verticesOf(const TriangleMesh& mesh) {
  CarrierParams own;
  own.longest_edge = 1e300;
  const auto carrier = carrierMeshOf(mesh, own);
  EXPECT_TRUE(carrier) << carrier.error().message;
  return carrier ? carrier->places : PlaceColumns();
}

RigidMotion smallMotion() {
  constexpr double kAngle = 0.01;
  RigidMotion motion;
  motion.rotation = {{{std::cos(kAngle), -std::sin(kAngle), 0},
                      {std::sin(kAngle), std::cos(kAngle), 0},
                      {0, 0, 1}}};
  motion.center = {0.3, -0.2, 0.1};
  motion.translation = {0.005, 0.003, 0.02};
  return motion;
}

TEST(Alignment, AMotionAndItsInverseAreNone) {
  const RigidMotion motion = smallMotion(), back = inverseOf(motion);
  const Vector3 p{1.5, -2.5, 0.7};
  const Vector3 twice = back.place(motion.place(p));
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(twice[a], p[a], 1e-15 * 10);
  EXPECT_GT(length(subtract(motion.place(p), p)), 0.01);
}

TEST(Alignment, FindsTheMotionAndAppliesItOnRequest) {
  const TriangleMesh mesh = sheet(40);
  const auto reference = DeviationReference::make(mesh);
  ASSERT_TRUE(reference) << reference.error().message;
  PlaceColumns places = verticesOf(mesh);
  const PlaceColumns original = places;
  places.move(inverseOf(smallMotion()));
  AlignmentParams params;
  const auto check = alignmentOf(*reference, places, params);
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_FALSE(check->turned);
  EXPECT_FALSE(check->unknown);
  EXPECT_EQ(check->forward(places).positions, places.positions);
  params.apply = true;
  const auto applied = alignmentOf(*reference, places, params);
  ASSERT_TRUE(applied);
  const PlaceColumns moved = applied->forward(places);
  double worst = 0;
  for (std::size_t i = 0; i < moved.size(); ++i)
    worst = std::max(worst, length(subtract(moved.positions[i], original.positions[i])));
  EXPECT_LT(worst, 1e-3);
  const PlaceColumns back = applied->backward(moved);
  for (std::size_t i = 0; i < back.size(); ++i)
    EXPECT_LT(length(subtract(back.positions[i], places.positions[i])), 1e-12);
}

TEST(Alignment, TurnsPlacesThatFaceTheOtherWay) {
  const TriangleMesh mesh = sheet(20);
  const auto reference = DeviationReference::make(mesh);
  ASSERT_TRUE(reference);
  PlaceColumns places = verticesOf(mesh);
  for (Vector3& p : places.positions) p[2] += 0.05;
  const auto alike = alignmentOf(*reference, places, {});
  places.turn();
  const auto turned = alignmentOf(*reference, places, {});
  ASSERT_TRUE(alike && turned);
  EXPECT_FALSE(alike->turned);
  EXPECT_TRUE(turned->turned);
  Deviations first, second;
  places.turn();
  EXPECT_FALSE(measureDeviations(*reference, alike->forward(places).view(), {}, first));
  places.turn();
  EXPECT_FALSE(measureDeviations(*reference, turned->forward(places).view(), {}, second));
  EXPECT_EQ(first.detection.size(), places.size());
  std::size_t found = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first.state[i] != FootState::kFound) continue;
    ++found;
    EXPECT_EQ(first.distance[i], second.distance[i]);
    EXPECT_GT(first.distance[i], 0.0f);
  }
  EXPECT_GT(found, places.size() / 2);
  places.oriented = false;
  EXPECT_FALSE(alignmentOf(*reference, places, {})->turned);
}

TEST(Alignment, PointsThatShareErrorsCountAsFew) {
  SLIMSurface surface;
  surface.resize(4);
  for (std::size_t i = 0; i < 3; ++i) surface.flags[i] = kSurfelLeaf;
  surface.info.num_points = 900;
  EXPECT_EQ(independentPlaces(surface, ScanPlaces::kMoved), 3.0);
  EXPECT_EQ(independentPlaces(surface, ScanPlaces::kMeasured), 900.0);
  surface.info.correlation = 9;
  EXPECT_EQ(independentPlaces(surface, ScanPlaces::kMeasured), 100.0);
}

TEST(Alignment, AnUnknownMotionIsAnErrorWhereItIsToBeApplied) {
  const auto reference = DeviationReference::make(sheet(10));
  ASSERT_TRUE(reference);
  PlaceColumns far;
  for (int i = 0; i < 50; ++i) far.positions.push_back({i * 0.01, 0, 100});
  AlignmentParams params;
  params.registration.feet.max_distance = 1;
  const auto check = alignmentOf(*reference, far, params);
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->unknown);
  EXPECT_EQ(check->forward(far).positions, far.positions);
  params.apply = true;
  EXPECT_FALSE(alignmentOf(*reference, far, params));
}

}  // namespace
}  // namespace pcl_slim

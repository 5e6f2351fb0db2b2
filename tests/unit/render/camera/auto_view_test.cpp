// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/auto_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pcl_slim/core/vector3.h"
#include "unit/render/camera/sphere_objects.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

void expectDirection(const std::array<double, 3>& actual, const std::array<double, 3>& expected) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(actual[k], expected[k], 1e-12);
}

TEST(ViewFromAngles, StandsWhereTheConventionSays) {
  expectDirection(viewFromAngles(UpAxis::kZ, 0.0, 0.0).towards_viewer, {0.0, -1.0, 0.0});
  expectDirection(viewFromAngles(UpAxis::kZ, 90.0, 0.0).towards_viewer, {1.0, 0.0, 0.0});
  expectDirection(viewFromAngles(UpAxis::kZ, 0.0, 90.0).towards_viewer, {0.0, 0.0, 1.0});
  expectDirection(viewFromAngles(UpAxis::kZ, 0.0, 90.0).up, {0.0, 1.0, 0.0});
  expectDirection(viewFromAngles(UpAxis::kY, 0.0, 0.0).towards_viewer, {0.0, 0.0, 1.0});
  expectDirection(viewFromAngles(UpAxis::kY, 90.0, 0.0).towards_viewer, {1.0, 0.0, 0.0});
  expectDirection(viewFromAngles(UpAxis::kY, 90.0, 0.0).up, {0.0, 1.0, 0.0});
}

TEST(GuessUpAxis, StatuesStandAndTerrainLies) {
  EXPECT_EQ(guessUpAxis(spheresOf(stretched(0.2, 0.2, 0.4))), UpAxis::kZ);
  EXPECT_EQ(guessUpAxis(spheresOf(stretched(0.2, 0.4, 0.2))), UpAxis::kY);
  EXPECT_EQ(guessUpAxis(spheresOf(stretched(0.3, 0.3, 0.3))), UpAxis::kZ);
  EXPECT_EQ(guessUpAxis(spheresOf(stretched(0.3, 0.4, 0.02))), UpAxis::kZ);
  EXPECT_EQ(guessUpAxis(spheresOf(stretched(0.3, 0.02, 0.4))), UpAxis::kY);
  SLIMSurface map = stretched(0.2, 0.4, 0.2);
  map.info.origin = {5e5, 5.4e6, 300.0};
  map.info.scale = 64.0;
  EXPECT_EQ(guessUpAxis(spheresOf(map)), UpAxis::kZ);
}

TEST(GuessUpAxis, AHeadThatIsAsDeepAsHighStandsOnItsNeck) {
  // Cut off below, it is hardly longer along z than along y.
  SLIMSurface head = stretched(0.26, 0.36, 0.301);
  for (std::size_t i = 0; i < head.size(); ++i) {
    if (head.ny[i] < -0.6f) head.flags[i] = 0;
  }
  EXPECT_EQ(guessUpAxis(spheresOf(head)), UpAxis::kY);
  // Closed by a flat cut instead.
  SLIMSurface bust = stretched(0.26, 0.3, 0.301);
  for (std::size_t i = 0; i < bust.size(); ++i) {
    if (bust.cy[i] > -0.15f) continue;
    bust.cy[i] = -0.15f;
    bust.nx[i] = bust.nz[i] = 0.0f;
    bust.ny[i] = -1.0f;
  }
  EXPECT_EQ(guessUpAxis(spheresOf(bust)), UpAxis::kY);
}

TEST(ChooseView, TerrainIsSeenFromAboveAcrossItsLongerSide) {
  const ViewDirection view = chooseView(spheresOf(stretched(0.5, 0.2, 0.01))).direction;
  EXPECT_GT(view.towards_viewer[2], 0.5);
  EXPECT_NEAR(view.towards_viewer[0], 0.0, 0.05);
}

TEST(ChooseView, MapsAreSeenFromAboveHoweverHighTheirTrees) {
  SLIMSurface map = stretched(0.5, 0.2, 0.25);
  const double beside = chooseView(spheresOf(map)).direction.towards_viewer[2];
  EXPECT_LT(beside, 0.4);
  map.info.origin = {5e5, 5.4e6, 300.0};
  map.info.scale = 64.0;
  const ViewDirection view = chooseView(spheresOf(map)).direction;
  EXPECT_GT(view.towards_viewer[2], 0.5);
  EXPECT_NEAR(view.towards_viewer[0], 0.0, 0.05);
}

TEST(ChooseView, OneSidedScanIsSeenFromItsSide) {
  SLIMSurface surface = stretched(0.25, 0.25, 0.4);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.nx[i] > 0.1f) surface.flags[i] = 0;  // nothing measured at +x
  }
  EXPECT_LT(chooseView(spheresOf(surface)).direction.towards_viewer[0], -0.8);
}

TEST(ChooseView, DepthCameraIsPutBackWhereItStood) {
  SLIMSurface surface = sphereSurface(2, 0.4, 500, 0.05, {0.0, 0.0, 1.0});
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.nz[i] > 0.1f) surface.flags[i] = 0;  // nothing seen from behind
  }
  const ViewDirection view = chooseView(spheresOf(surface)).direction;
  EXPECT_LT(view.towards_viewer[2], -0.9);
  EXPECT_LT(view.up[1], -0.9);
}

TEST(GuessUpAxis, AnAnimalStandsOnItsLegsHoweverLongItIs) {
  // Along z, with a head before its legs and a tail; y is up.
  BoundingSpheres animal;
  addBox({-0.1, 0.2, -0.3}, {0.1, 0.4, 0.3}, 0.02, animal);
  addBox({-0.06, 0.35, 0.3}, {0.06, 0.5, 0.45}, 0.02, animal);
  addBox({-0.02, 0.3, -0.38}, {0.02, 0.34, -0.3}, 0.01, animal);
  for (const double x : {-0.1, 0.06}) {
    for (const double z : {-0.28, 0.24}) addBox({x, 0, z}, {x + 0.04, 0.2, z + 0.04}, 0.01, animal);
  }
  EXPECT_EQ(guessUpAxis(animal), UpAxis::kY);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double angle : {-3.0, 3.0})
      EXPECT_EQ(guessUpAxis(turned(animal, axis, angle)), UpAxis::kY) << axis << ' ' << angle;
  }
  BoundingSpheres thin = animal;
  thin.spheres.clear();
  for (std::size_t i = 0; i < animal.spheres.size(); i += 3)
    thin.spheres.push_back(animal.spheres[i]);
  EXPECT_EQ(guessUpAxis(thin), UpAxis::kY);
}

TEST(GuessUpAxis, AColumnDoesNotLieDownThoughItWouldLieBetter) {
  BoundingSpheres column;
  addBox({-0.1, -0.1, -0.4}, {0.1, 0.1, 0.4}, 0.02, column);
  for (const double angle : {0.0, -5.0, 5.0})
    EXPECT_EQ(guessUpAxis(turned(column, 0, angle)), UpAxis::kZ) << angle;
}

TEST(ChooseView, LooksDownIntoARoom) {
  BoundingSpheres room;
  addBox({0, 0, 0}, {6, 4, 2.5}, 0.1, room, -1.0f);
  addBox({1, 1, 0}, {2, 2, 0.8}, 0.1, room);
  for (const double angle : {0.0, 5.0, 20.0}) {
    EXPECT_TRUE(chooseView(turned(room, 2, angle)).opens);
    const ViewDirection view = chooseView(turned(room, 2, angle)).direction;
    EXPECT_GT(view.towards_viewer[2], 0.5);
    EXPECT_GT(view.up[2], 0.5);
  }
  BoundingSpheres house;
  addBox({0, 0, 0}, {6, 4, 2.5}, 0.1, house);
  EXPECT_FALSE(chooseView(house).opens);
  EXPECT_FALSE(chooseView(spheresOf(stretched(0.2, 0.2, 0.4))).opens);
}

TEST(ChooseView, AMapAsLongAsWideIsSeenFromTheFrontHoweverItIsSampled) {
  // A fortieth longer along a diagonal: no reason to turn the picture.
  const ViewDirection square =
      chooseView(turned(spheresOf(stretched(0.41, 0.4, 0.01)), 2, 45)).direction;
  EXPECT_NEAR(square.towards_viewer[0], 0.0, 0.05);
  const ViewDirection strip =
      chooseView(turned(spheresOf(stretched(0.5, 0.2, 0.01)), 2, 45)).direction;
  EXPECT_GT(std::abs(strip.towards_viewer[0]), 0.4);
}
/** A sheet across an axis, which faces the given way along it. */
void addSheet(std::size_t axis, double at, float way, const Vector3& low, const Vector3& high,
              double spacing, BoundingSpheres& object) {
  const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
  for (double u = low[b] + 0.5 * spacing; u < high[b]; u += spacing) {
    for (double v = low[c] + 0.5 * spacing; v < high[c]; v += spacing) {
      BoundingSphere sphere{{}, static_cast<float>(spacing), {}};
      sphere.center[axis] = static_cast<float>(at);
      sphere.center[b] = static_cast<float>(u);
      sphere.center[c] = static_cast<float>(v);
      sphere.normal[axis] = way;
      object.spheres.push_back(sphere);
    }
  }
}

/** The corner of a room with a table, z up, as seen from y < 0 and x > 0. */
BoundingSpheres roomCorner() {
  const Vector3 low{-2, -2, 0}, high{2, 2, 2.4};
  BoundingSpheres corner;
  addSheet(2, 0.0, 1.0f, low, high, 0.1, corner);
  addSheet(1, 2.0, -1.0f, low, high, 0.1, corner);
  addSheet(0, -2.0, 1.0f, low, high, 0.1, corner);
  addSheet(2, 0.7, 1.0f, {-1, 0, 0}, {0.5, 1, 0}, 0.1, corner);
  return corner;
}

/** A street along x about the origin: its ground and the fronts of houses, with gaps. */
BoundingSpheres street() {
  BoundingSpheres object;
  addSheet(2, -1.8, 1.0f, {-25, -6, 0}, {25, 6, 0}, 0.5, object);
  for (const double x : {-24.0, -10.0, 4.0}) {
    addSheet(1, 6.0, -1.0f, {x, 0, -1.8}, {x + 12, 0, 5}, 0.5, object);
    addSheet(1, -6.0, 1.0f, {x + 3, 0, -1.8}, {x + 15, 0, 5}, 0.5, object);
  }
  object.scale = 10.0;
  for (BoundingSphere& sphere : object.spheres) {
    for (float& c : sphere.center) c /= 10.0f;
    sphere.radius /= 10.0f;
  }
  return object;
}

/** Half of the spheres, with coordinates rounded to a step. */
BoundingSpheres thinnedAndRounded(const BoundingSpheres& object, float step) {
  std::mt19937 random(7);
  BoundingSpheres half = object;
  half.spheres.clear();
  for (BoundingSphere sphere : object.spheres) {
    if (random() % 2 == 0) continue;
    for (float& c : sphere.center) c = std::round(c / step) * step;
    half.spheres.push_back(sphere);
  }
  return half;
}

/** Share of an object's spheres that face a camera. */
double shareFacing(const BoundingSpheres& object, const Camera& camera) {
  double facing = 0;
  for (const BoundingSphere& sphere : object.spheres) {
    const Vector3 c{sphere.center[0], sphere.center[1], sphere.center[2]};
    const Vector3 n{sphere.normal[0], sphere.normal[1], sphere.normal[2]};
    const Vector3 at = along(object.origin, object.scale, c);
    facing += dot(subtract(camera.position, at), n) > 0;
  }
  return facing / static_cast<double>(object.spheres.size());
}

TEST(ChooseView, OfARoomsCornerStandsOnItsFloorWhicheverAxisIsUp) {
  const std::vector<std::pair<double, Vector3>> axes = {
      {0, {0, 0, 1}}, {-90, {0, 1, 0}}, {180, {0, 0, -1}}};
  for (const auto& [angle, up] : axes) {
    const BoundingSpheres all = turned(roomCorner(), 0, angle);
    for (const BoundingSpheres& corner : {all, thinnedAndRounded(all, 0.02f), turned(all, 2, 3)}) {
      const SceneView view = chooseView(corner);
      for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(view.up[a], up[a]) << angle;
      EXPECT_GT(shareFacing(corner, cameraFor(view, corner, {80, 60})), 0.95) << angle;
      EXPECT_FALSE(view.amid);
      EXPECT_FALSE(view.opens);
    }
  }
}

TEST(ChooseView, StandsInAStreetAndLooksAlongIt) {
  for (const double angle : {0.0, 20.0, 77.0, 140.0}) {
    const BoundingSpheres all = turned(street(), 2, angle);
    for (const BoundingSpheres& scan : {all, thinnedAndRounded(all, 0.01f)}) {
      const SceneView view = chooseView(scan);
      ASSERT_TRUE(view.amid) << angle;
      EXPECT_EQ(view.axis, UpAxis::kZ);
      const Camera camera = cameraFor(view, scan, {80, 60});
      EXPECT_GT(shareFacing(scan, camera), 0.99);
      EXPECT_EQ(camera.fov, 60.0);
      const Vector3 ahead = normalized(subtract(camera.look_at, camera.position));
      const double turn = angle * M_PI / 180;
      EXPECT_GT(std::abs(dot(ahead, {std::cos(turn), std::sin(turn), 0})), 0.97) << angle;
    }
  }
  EXPECT_EQ(chooseView(street(), UpAxis::kMinusZ).up[2], -1.0);
}

TEST(ChooseView, ACameraThatLooksAgainstZHasYUp) {
  BoundingSpheres seen = turned(roomCorner(), 0, -90);  // y up, its back wall at z = -2
  seen.origin = {0.0, -1.0, -4.0};
  const SceneView view = chooseView(seen);
  EXPECT_EQ(view.axis, UpAxis::kY);
  EXPECT_GT(view.direction.towards_viewer[2], 0.7);
  EXPECT_GT(shareFacing(seen, cameraFor(view, seen, {80, 60})), 0.95);
}

TEST(ChooseView, ATableStandsOnItsLegs) {
  BoundingSpheres table;
  addBox({-0.7, -0.4, 0.7}, {0.7, 0.4, 0.73}, 0.02, table);
  for (const double x : {-0.7, 0.64}) {
    for (const double y : {-0.4, 0.34}) addBox({x, y, 0}, {x + 0.06, y + 0.06, 0.7}, 0.02, table);
  }
  EXPECT_EQ(guessUpAxis(table), UpAxis::kZ);
  EXPECT_EQ(guessUpAxis(turned(table, 0, -90)), UpAxis::kY);
}

TEST(ChooseView, SaysWhereItIsSeenFrom) {
  EXPECT_EQ(chooseView(spheresOf(stretched(0.2, 0.2, 0.4))).from, "from the front-right");
  EXPECT_EQ(chooseView(spheresOf(stretched(0.5, 0.2, 0.01))).from, "from above, the front");
  EXPECT_EQ(chooseView(street()).from, "from amid the scene");
  EXPECT_EQ(nameOf(UpAxis::kMinusY), "-y");
}

TEST(SpheresOf, TrianglesWeighTheirAreaAndLargeOnesAreInPieces) {
  const BoundingSpheres mesh = spheresOf({{0, 0, 5}, {2, 0, 5}, {0, 2, 5}, {0, 0, 6}, {1e9, 0, 0}},
                                         {{0, 1, 2}, {0, 2, 3}, {1, 1, 2}});
  double flat = 0, upright = 0;
  for (const BoundingSphere& sphere : mesh.spheres) {
    EXPECT_LT(sphere.radius, 0.05f);
    (sphere.normal[2] > 0.5f ? flat : upright) += sphere.points;
  }
  EXPECT_NEAR(flat / upright, 2.0, 1e-4);
  EXPECT_NEAR(mesh.scale, 3.0, 1e-12);  // the corner of no triangle does not count
  EXPECT_TRUE(spheresOf(std::vector<Vector3>(), {}).spheres.empty());
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/surface_renderer.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief Bounds of the covered pixels: x0, y0, x1, y1. */
std::array<int, 4> coveredBounds(const GBuffer& buffer) {
  std::array<int, 4> bounds{buffer.width, buffer.height, -1, -1};
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      if (!buffer.covered(buffer.index(x, y))) continue;
      bounds = {std::min(bounds[0], x), std::min(bounds[1], y), std::max(bounds[2], x),
                std::max(bounds[3], y)};
    }
  }
  return bounds;
}

void expectDirection(const std::array<double, 3>& actual, const std::array<double, 3>& expected) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(actual[k], expected[k], 1e-12);
}

TEST(MayBeSeen, HoldsForEveryBoxThatIsInThePicture) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  std::size_t hidden = 0;
  for (const bool parallel : {false, true}) {
    Camera camera = fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 20), {160, 120});
    if (parallel) {
      camera.projection = Camera::Projection::kOrthographic;
      camera.view_height = 0.2;
    } else {
      camera.fov = 5.0;
    }
    const GBuffer all = rendered(surface, camera);
    for (std::uint32_t i = 0; i < surface.size(); ++i) {
      const std::array<double, 3> c{surface.cx[i], surface.cy[i], surface.cz[i]};
      std::array<std::array<double, 3>, 2> box{c, c};
      for (std::size_t a = 0; a < 3; ++a) {
        box[0][a] -= double{surface.radius[i]};
        box[1][a] += double{surface.radius[i]};
      }
      const bool drawn = std::find(all.surfel.begin(), all.surfel.end(), i) != all.surfel.end();
      const bool seen = mayBeSeen(camera, box);
      EXPECT_TRUE(seen || !drawn) << i;
      hidden += !seen;
    }
  }
  EXPECT_GT(hidden, surface.size() / 2);
  Camera behind;
  behind.position = {0, 0, -9};
  behind.look_at = {0, 0, -10};
  EXPECT_FALSE(mayBeSeen(behind, {{{-1, -1, -1}, {1, 1, 1}}}));
  EXPECT_TRUE(mayBeSeen(behind, {{{-1, -1, -20}, {1, 1, 1}}}));
}

TEST(FitCamera, FramesTheWholeObjectTightlyAndCentred) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  surface.info.origin = {5000.0, 300.0, -20.0};
  surface.info.scale = 4.0;
  for (const double azimuth : {0.0, 77.0, 200.0}) {
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, azimuth, 35.0), {160, 120});
    const auto b = coveredBounds(rendered(surface, camera));
    EXPECT_GT(b[1], 0);
    EXPECT_LT(b[3], 119);
    EXPECT_GT(b[3] - b[1], 95);        // 92 % of the height less the leaves' own reach
    EXPECT_NEAR(b[1] + b[3], 119, 3);  // centred
    EXPECT_NEAR(b[0] + b[2], 159, 3);
  }
}

TEST(FitCamera, OrthographicFramesAsWell) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  const Camera camera =
      fitOrthographicCamera(spheresOf(surface), viewFromAngles(UpAxis::kY, 20.0, 10.0), {120, 160});
  const auto b = coveredBounds(rendered(surface, camera));
  EXPECT_GT(b[0], 0);
  EXPECT_LT(b[2], 119);
  EXPECT_GT(b[2] - b[0], 95);
  EXPECT_NEAR(b[0] + b[2], 119, 3);
  EXPECT_NEAR(b[1] + b[3], 159, 3);
}

TEST(FitCamera, OneStrayLeafDoesNotShrinkTheObject) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 0.0, 0.0);
  const Camera before = fitCamera(spheresOf(surface), view, {160, 120});
  surface.cx[17] = 40.0f;
  const Camera after = fitCamera(spheresOf(surface), view, {160, 120});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(before.position[k], after.position[k], 0.02);
}

// Of two spheres none is a stray, on whichever axes they lie apart.
TEST(FitCamera, TwoSpheresAreBothFramed) {
  BoundingSpheres object;
  object.scale = 1e-38;
  object.spheres = {{{0.0f, 0.01f, 0.0f}, 0.2f, {0.0f, 0.0f, 1.0f}},
                    {{0.0f, 0.0f, 0.01f}, 0.2f, {0.0f, 0.0f, 1.0f}}};
  const Camera camera = fitCamera(object, viewFromAngles(UpAxis::kZ, 20.0, 30.0), {160, 120});
  EXPECT_LT(std::abs(camera.position[0]), 1e-36);
  EXPECT_FALSE(camera.validate());
}

TEST(FitCamera, APieceApartIsNotFramedButLargeOnesAre) {
  const SLIMSurface sphere = sphereSurface(4, 0.25, 600, 0.07);
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 0.0, 0.0);
  const Camera before = fitCamera(spheresOf(sphere), view, {160, 120});
  // Four leaves aside, near enough to count by their distance.
  BoundingSpheres strays = spheresOf(sphere);
  for (std::size_t i = 0; i < 4; ++i) strays.spheres[i].center = {0.5f, 0.0f, 0.01f * i};
  const Camera with_strays = fitCamera(strays, view, {160, 120});
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(before.position[k], with_strays.position[k], 0.03);
  }
  BoundingSpheres two = spheresOf(sphere);
  for (const BoundingSphere& sphere_part : spheresOf(sphere).spheres) {
    two.spheres.push_back(sphere_part);
    two.spheres.back().center[0] += 1.0f;
  }
  EXPECT_NEAR(fitCamera(two, view, {160, 120}).position[0], 0.5, 0.03);
}

TEST(FitCamera, AMarginAtTheRightStaysFree) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 30.0, 20.0);
  for (const bool parallel : {false, true}) {
    const Camera camera =
        parallel ? fitOrthographicCamera(spheresOf(surface), view, {120, 120}, 0.04, 0.3)
                 : fitCamera(spheresOf(surface), view, {120, 120}, 30.0, 0.04, 0.3);
    const auto b = coveredBounds(rendered(surface, camera));
    EXPECT_GT(b[0], 0) << parallel;
    EXPECT_LT(b[2], 84) << parallel;
    EXPECT_GT(b[2] - b[0], 60) << parallel;
  }
}

TEST(FitCamera, EmptySurfaceAndSinglePointGiveValidCameras) {
  SLIMSurface surface;
  EXPECT_FALSE(fitCamera(spheresOf(surface), chooseView(spheresOf(surface)), {80, 60}).validate());
  EXPECT_FALSE(fitOrthographicCamera(spheresOf(surface), chooseView(spheresOf(surface)), {80, 60})
                   .validate());
  surface = sphereSurface(2, 0.25, 1, 0.07);
  EXPECT_FALSE(fitCamera(spheresOf(surface), chooseView(spheresOf(surface)), {80, 60}).validate());
  EXPECT_FALSE(fitOrthographicCamera(spheresOf(surface), chooseView(spheresOf(surface)), {80, 60})
                   .validate());
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

/** \brief The sphere's leaves stretched along each axis (their polynomials do not matter here). */
SLIMSurface stretched(double x, double y, double z) {
  SLIMSurface surface = sphereSurface(2, 1.0, 500, 0.05);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    surface.cx[i] *= static_cast<float>(x);
    surface.cy[i] *= static_cast<float>(y);
    surface.cz[i] *= static_cast<float>(z);
  }
  return surface;
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
  // Closed by a flat cut instead, normals without a side.
  SLIMSurface bust = stretched(0.26, 0.3, 0.301);
  bust.info.oriented = false;
  for (std::size_t i = 0; i < bust.size(); ++i) {
    if (bust.cy[i] > -0.15f) continue;
    bust.cy[i] = -0.15f;
    bust.nx[i] = bust.nz[i] = 0.0f;
    bust.ny[i] = -1.0f;
  }
  EXPECT_EQ(guessUpAxis(spheresOf(bust)), UpAxis::kZ);  // longer along z: .3 + .15 against .6
  for (float& z : bust.cz) z *= 0.75f;
  EXPECT_EQ(guessUpAxis(spheresOf(bust)), UpAxis::kY);
}

TEST(ChooseView, TerrainIsSeenFromAboveAcrossItsLongerSide) {
  const ViewDirection view = chooseView(spheresOf(stretched(0.5, 0.2, 0.01)));
  EXPECT_GT(view.towards_viewer[2], 0.5);
  EXPECT_NEAR(view.towards_viewer[0], 0.0, 0.05);
}

TEST(ChooseView, MapsAreSeenFromAboveHoweverHighTheirTrees) {
  SLIMSurface map = stretched(0.5, 0.2, 0.25);
  const double beside = chooseView(spheresOf(map)).towards_viewer[2];
  EXPECT_LT(beside, 0.4);
  map.info.origin = {5e5, 5.4e6, 300.0};
  map.info.scale = 64.0;
  const ViewDirection view = chooseView(spheresOf(map));
  EXPECT_GT(view.towards_viewer[2], 0.5);
  EXPECT_NEAR(view.towards_viewer[0], 0.0, 0.05);
}

TEST(ChooseView, OneSidedScanIsSeenFromItsSide) {
  SLIMSurface surface = stretched(0.25, 0.25, 0.4);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.nx[i] > 0.1f) surface.flags[i] = 0;  // nothing measured at +x
  }
  EXPECT_LT(chooseView(spheresOf(surface)).towards_viewer[0], -0.8);
  surface.info.oriented = false;  // the normals say nothing then
  EXPECT_GT(chooseView(spheresOf(surface)).towards_viewer[0], 0.0);
}

TEST(FitCamera, SeesWhatLiesWhereAUnitIsLost) {
  SLIMSurface surface = stretched(0.25, 0.25, 0.4);
  surface.info.scale = 1e24;
  surface.info.origin = {3e25, -1e24, 2e24};
  const BoundingSpheres spheres = spheresOf(surface);
  const Camera camera = fitCamera(spheres, chooseView(spheres), {40, 30});
  EXPECT_FALSE(camera.validate()) << camera.validate().message;
}

TEST(ChooseView, DepthCameraIsPutBackWhereItStood) {
  SLIMSurface surface = sphereSurface(2, 0.4, 500, 0.05, {0.0, 0.0, 1.0});
  const ViewDirection view = chooseView(spheresOf(surface));
  EXPECT_LT(view.towards_viewer[2], -0.9);
  EXPECT_LT(view.up[1], -0.9);
}

/** The faces of a box as spheres, a point each, with outward normals; sides of it turn these
 * inward. */
void addBox(const std::array<double, 3>& low, const std::array<double, 3>& high, double spacing,
            BoundingSpheres& object, float side = 1.0f) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    for (const double end : {low[a], high[a]}) {
      for (double u = low[b] + 0.5 * spacing; u < high[b]; u += spacing) {
        for (double v = low[c] + 0.5 * spacing; v < high[c]; v += spacing) {
          BoundingSphere sphere{{}, static_cast<float>(spacing), {}};
          sphere.center[a] = static_cast<float>(end);
          sphere.center[b] = static_cast<float>(u);
          sphere.center[c] = static_cast<float>(v);
          sphere.normal[a] = end == low[a] ? -side : side;
          object.spheres.push_back(sphere);
        }
      }
    }
  }
}

/** Turns an object about an axis. */
BoundingSpheres turned(BoundingSpheres object, std::size_t axis, double degrees) {
  const auto c = static_cast<float>(std::cos(degrees * M_PI / 180)),
             s = static_cast<float>(std::sin(degrees * M_PI / 180));
  const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
  for (BoundingSphere& sphere : object.spheres) {
    for (auto* v : {&sphere.center, &sphere.normal}) {
      const float x = (*v)[b], y = (*v)[d];
      (*v)[b] = c * x - s * y;
      (*v)[d] = s * x + c * y;
    }
  }
  return object;
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
  room.oriented = false;  // as one fitted without normals
  for (const double angle : {0.0, 5.0, 20.0}) {
    EXPECT_TRUE(isSeenFromInside(turned(room, 2, angle)));
    const ViewDirection view = chooseView(turned(room, 2, angle));
    EXPECT_GT(view.towards_viewer[2], 0.5);
    EXPECT_GT(view.up[2], 0.5);
  }
  BoundingSpheres house;
  addBox({0, 0, 0}, {6, 4, 2.5}, 0.1, house);
  EXPECT_FALSE(isSeenFromInside(house));
  EXPECT_FALSE(isSeenFromInside(spheresOf(stretched(0.2, 0.2, 0.4))));
}

TEST(ChooseView, AMapAsLongAsWideIsSeenFromTheFrontHoweverItIsSampled) {
  // A fortieth longer along a diagonal: no reason to turn the picture.
  const ViewDirection square = chooseView(turned(spheresOf(stretched(0.41, 0.4, 0.01)), 2, 45));
  EXPECT_NEAR(square.towards_viewer[0], 0.0, 0.05);
  const ViewDirection strip = chooseView(turned(spheresOf(stretched(0.5, 0.2, 0.01)), 2, 45));
  EXPECT_GT(std::abs(strip.towards_viewer[0]), 0.4);
}

TEST(FitCamera, FramesWhereThePointsAreNotTheFarEnd) {
  // A lidar: most points near by, few of large discs far away; and a spit off a coast.
  BoundingSpheres coast;
  addBox({0, 0, 0}, {1, 1, 0.05}, 0.02, coast);
  const ViewDirection above = viewFromAngles(UpAxis::kZ, 0.0, 42.0);
  const Camera land = fitCamera(coast, above, {160, 120});
  for (int k = 0; k < 60; ++k) {
    const float x = 1.0f + 0.08f * static_cast<float>(k);
    coast.spheres.push_back({{x, 0.5f, 0.0f}, 0.1f, {0.0f, 0.0f, 1.0f}});
  }
  const auto far = [](const Camera& c) { return length(subtract(c.position, {0.5, 0.5, 0.0})); };
  EXPECT_LT(far(fitCamera(coast, above, {160, 120})), 1.7 * far(land));
  // The same by the points behind few large spheres.
  BoundingSpheres scan = coast;
  for (BoundingSphere& sphere : scan.spheres) sphere.points = sphere.center[0] > 1 ? 1.0f : 40.0f;
  EXPECT_LT(far(fitCamera(scan, above, {160, 120})), 1.7 * far(land));
  // Where the far end has the points, it is what the picture shows.
  for (BoundingSphere& sphere : scan.spheres) sphere.points = sphere.center[0] > 1 ? 400.0f : 1.0f;
  EXPECT_GT(fitCamera(scan, above, {160, 120}).position[0], 2.0);
}

}  // namespace
}  // namespace pcl_slim

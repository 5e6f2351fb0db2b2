// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/turning.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/auto_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief A long thing with a foot at one end: turned, it is far wider than seen along. */
BoundingSpheres longObject() {
  BoundingSpheres object;
  object.origin = {500.0, -20.0, 3.0};
  object.scale = 2.0;
  object.seen_radius = 1.0;
  for (int i = 0; i <= 100; ++i) {
    const float x = 0.01f * static_cast<float>(i);
    object.spheres.push_back({{0.05f, x, 0.2f}, 0.02f, {0.0f, 0.0f, 1.0f}});
    object.spheres.push_back({{0.05f, 0.9f, 0.4f * x}, 0.02f, {0.0f, 0.0f, 1.0f}});
  }
  return object;
}

/** \brief How far a sphere's centre is from the picture's middle, 1 at its edge, in the worse of
 * both directions. */
double offMiddle(const BoundingSphere& sphere, const BoundingSpheres& object,
                 const Camera& camera) {
  const auto& c = sphere.center;
  const Vector3 at = along(object.origin, object.scale, {c[0], c[1], c[2]});
  const Vector3 forward = normalized(subtract(camera.look_at, camera.position));
  const Vector3 right = normalized(cross(forward, camera.up)), up = cross(right, forward);
  const Vector3 to = subtract(at, camera.position);
  const bool parallel = camera.projection == Camera::Projection::kOrthographic;
  const double half = parallel ? 0.5 * camera.view_height
                               : dot(to, forward) * std::tan(camera.fov * std::acos(-1.0) / 360.0);
  const double aspect = static_cast<double>(camera.size.width) / camera.size.height;
  return std::max(std::abs(dot(to, right)) / (half * aspect), std::abs(dot(to, up)) / half);
}

TEST(SweptAbout, ACameraThatFramesItSeesTheObjectFromEverySide) {
  const BoundingSpheres object = longObject();
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 90.0, 20.0);
  const Vector3 axis{0.0, 0.0, 1.0};
  const BoundingSpheres swept = sweptAbout(object, axis);
  constexpr int kTurns = 24;
  for (const bool parallel : {false, true}) {
    const Camera first = parallel ? fitOrthographicCamera(swept, view, {160, 120})
                                  : fitCamera(swept, view, {160, 120});
    double widest = 0.0;
    for (int turn = 0; turn < kTurns; ++turn) {
      const Camera camera = turnedCamera(first, swept.origin, axis, turn, kTurns);
      for (const BoundingSphere& sphere : object.spheres) {
        widest = std::max(widest, offMiddle(sphere, object, camera));
      }
    }
    EXPECT_LT(widest, 1.0) << parallel;
    EXPECT_GT(widest, 0.8) << parallel;  // and no farther off than it takes
  }
}

TEST(SweptAbout, AnEmptyObjectStaysAsItIs) {
  BoundingSpheres object;
  object.origin = {1.0, 2.0, 3.0};
  const BoundingSpheres swept = sweptAbout(object, {0.0, 1.0, 0.0});
  EXPECT_TRUE(swept.spheres.empty());
  EXPECT_EQ(swept.origin, object.origin);
}

TEST(TurnedCamera, KeepsUprightWhatStandsUpright) {
  const ViewDirection view = viewFromAngles(UpAxis::kY, 0.0, 40.0);
  const Camera first = fitCamera(longObject(), view, {160, 120});
  const Vector3 axis{0.0, 2.0, 0.0}, pivot{500.0, -19.0, 3.2};
  const Camera quarter = turnedCamera(first, pivot, axis, 1, 4);
  // Height above the pivot, distance, slope and upward direction stay; the viewer goes to the
  // right.
  EXPECT_NEAR(quarter.position[1], first.position[1], 1e-12);
  EXPECT_NEAR(quarter.position[0] - pivot[0], first.position[2] - pivot[2], 1e-12);
  EXPECT_NEAR(quarter.up[1], first.up[1], 1e-12);
  EXPECT_NEAR(quarter.look_at[1] - quarter.position[1], first.look_at[1] - first.position[1],
              1e-12);
}

TEST(ChooseView, UpIsTheAxisHoweverFarTheViewLooksDown) {
  BoundingSpheres terrain = longObject();
  for (BoundingSphere& sphere : terrain.spheres) sphere.center[2] *= 0.01f;
  EXPECT_EQ(chooseView(terrain, UpAxis::kZ).up, (Vector3{0.0, 0.0, 1.0}));
  EXPECT_EQ(chooseView(terrain, UpAxis::kX).up, (Vector3{1.0, 0.0, 0.0}));
  // A depth camera's y points downwards.
  SLIMSurface ahead = sphereSurface(2, 0.4, 500, 0.05, {0.0, 0.0, 1.0});
  for (std::size_t i = 0; i < ahead.size(); ++i) {
    if (ahead.nz[i] > 0.1f) ahead.flags[i] = 0;
  }
  EXPECT_EQ(chooseView(spheresOf(ahead)).up, (Vector3{0.0, -1.0, 0.0}));
}

}  // namespace
}  // namespace pcl_slim

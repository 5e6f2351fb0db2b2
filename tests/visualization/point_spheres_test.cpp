// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/auto_view.h"

namespace pcl_slim::test {
namespace {

/** \brief The half of a ball that faces +x, larger than the sample, with a point that is none. */
struct HalfBall {
  std::vector<std::array<float, 3>> points, normals;

  HalfBall() {
    for (int i = 0; i < 60000; ++i) {
      const double z = 2.0 * (i + 0.5) / 60000.0 - 1.0,
                   angle = std::acos(-1.0) * ((i % 97) / 97.0 - 0.5);
      const double r = std::sqrt(1.0 - z * z);
      const std::array<float, 3> n{static_cast<float>(r * std::cos(angle)),
                                   static_cast<float>(r * std::sin(angle)), static_cast<float>(z)};
      normals.push_back(n);
      points.push_back({n[0] + 10.0f, n[1], 2.0f * n[2]});
    }
    points[0][1] = std::numeric_limits<float>::quiet_NaN();
  }

  CloudView view(bool with_normals) const {
    CloudView view;
    view.xyz = points.data();
    view.xyz_stride = sizeof(points[0]);
    view.size = points.size();
    if (with_normals) {
      view.normal = normals.data();
      view.normal_stride = sizeof(normals[0]);
    }
    return view;
  }
};

TEST(PointSpheresTest, AScanWithNormalsIsSeenFromTheirSide) {
  const HalfBall scan;
  const BoundingSpheres seen = spheresOfPoints(scan.view(true));
  EXPECT_GT(chooseView(seen).direction.towards_viewer[0], 0.8);
  const BoundingSpheres blind = spheresOfPoints(scan.view(false));
  EXPECT_LT(chooseView(blind).direction.towards_viewer[0], 0.8);
}

TEST(PointSpheresTest, LiesWhereThePointsDo) {
  const HalfBall scan;
  const BoundingSpheres object = spheresOfPoints(scan.view(false));
  EXPECT_LE(object.spheres.size(), 20000u);
  EXPECT_GT(object.spheres.size(), 10000u);
  for (const BoundingSphere& sphere : object.spheres) {
    const auto& c = sphere.center;
    const Vector3 p = along(object.origin, object.scale, {c[0], c[1], c[2]});
    EXPECT_NEAR(std::hypot(p[0] - 10.0, p[1], 0.5 * p[2]), 1.0, 1e-5);
  }
  EXPECT_TRUE(spheresOfPoints(CloudView()).spheres.empty());
}

}  // namespace
}  // namespace pcl_slim::test

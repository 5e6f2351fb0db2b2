// SPDX-License-Identifier: BSD-3-Clause
// What projection says of borders, beside the plain evaluation of trim maps.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr float kLeafRadius = 0.2f;

/** Level leaves about the store's origin, turned about z in steps: some open, some closed. */
SLIMSurface levelLeaves(const PointStore& store, std::size_t count) {
  SLIMSurface surface;
  surface.info.degree = 1;
  surface.info.oriented = true;
  surface.info.origin = store.origin();
  surface.info.scale = store.scale();
  surface.info.diagonal = store.diagonal();
  surface.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    surface.cx[i] = 0.02f * static_cast<float>(i);
    surface.nz[i] = i % 2 == 0 ? 1.0f : -1.0f;
    surface.radius[i] = kLeafRadius;
    surface.degree[i] = 1;
    surface.flags[i] = kSurfelLeaf;
  }
  setRandomTrimMaps(surface);
  return surface;
}

/** The share outside at a place of the plane, as docs/theory.md has it ("Borders"). */
double outsideOf(const SLIMSurface& surface, double x, double y) {
  double weight = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
    const double dx = (x - surface.cx[i]) / kLeafRadius, dy = (y - surface.cy[i]) / kLeafRadius;
    const double w = evaluateKernel(surface.info.blend_kernel, dx * dx + dy * dy);
    weight += w;
    outside += w * outsideShare(surface.trimMap(i), dx * frame.u[0] + dy * frame.u[1],
                                dx * frame.v[0] + dy * frame.v[1]);
  }
  return weight > 0.0 ? outside / weight : 1.0;
}

TEST(ProjectionInside, IsWhatTheTrimMapsSay) {
  const PointStore store = storeOf(heightField(20000, 5, [](double, double) { return 0.0; }));
  for (const std::size_t count : {2u, 3u, 40u}) {
    SLIMSurface surface = levelLeaves(store, count);
    surface.info.oriented = false;
    Projection projection;
    ASSERT_FALSE(projectPoints(store, surface, {}, projection));
    std::size_t inside = 0, outside = 0;
    for (std::size_t i = 0; i < store.size(); ++i) {
      const auto p = store.position(i);
      if (!projection.supported[i]) {
        EXPECT_EQ(projection.inside[i], 0);
        continue;
      }
      const double share = outsideOf(surface, p[0], p[1]);
      if (std::abs(share - 0.5) < 1e-4) continue;  // rounding decides
      EXPECT_EQ(projection.inside[i] != 0, share < 0.5) << p[0] << ' ' << p[1];
      (projection.inside[i] ? inside : outside) += 1;
    }
    EXPECT_GT(inside, 100u);
    EXPECT_GT(outside, 100u);
  }
}

TEST(ProjectionInside, MovesNothing) {
  const PointStore store = storeOf(heightField(5000, 6, [](double, double) { return 0.0; }));
  SLIMSurface surface = levelLeaves(store, 9);
  surface.info.oriented = false;
  Projection open, closed;
  ASSERT_FALSE(projectPoints(store, surface, {}, open));
  surface.dropTrimMaps();
  ASSERT_FALSE(projectPoints(store, surface, {}, closed));
  EXPECT_EQ(open.position, closed.position);
  EXPECT_EQ(open.normal, closed.normal);
  EXPECT_EQ(open.supported, closed.supported);
  EXPECT_EQ(closed.inside, closed.supported);
  EXPECT_NE(open.inside, closed.inside);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Leaves whose found sides contradict those around them.
#include <gtest/gtest.h>

#include <vector>

#include "orient.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

double turnedOutward(const SLIMSurface& surface, const PointStore& store) {
  double right = 0, all = 0;
  for (const std::uint32_t i : surface.leaves()) {
    const Vector3 p = along(surface.info.origin, surface.info.scale,
                            {surface.cx[i], surface.cy[i], surface.cz[i]});
    EXPECT_GT(dot(p, {surface.nx[i], surface.ny[i], surface.nz[i]}), 0);
  }
  for (std::size_t p = 0; p < store.size(); ++p) {
    const Vector3 place = along(store.origin(), store.scale(), store.position(p));
    const std::array<float, 3> n = store.normal(p);
    right += dot(place, {n[0], n[1], n[2]}) > 0 ? 1 : 0;
    ++all;
  }
  return right / all;
}

TEST(ContradictedSides, APatchOfASphereTurnsWithItsPoints) {
  const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kSphere, 20000, 0.002);
  auto fit = pcl_slim_test::fitted(cloud.withoutNormals());
  std::vector<std::array<float, 3>> sides(fit.store.size());
  const auto isInPatch = [](const Vector3& p) { return p[2] > 0.75; };
  for (std::size_t p = 0; p < sides.size(); ++p) {
    const Vector3 place = along(fit.store.origin(), fit.store.scale(), fit.store.position(p));
    const double way = isInPatch(place) ? -1 : 1;
    for (std::size_t a = 0; a < 3; ++a) sides[p][a] = static_cast<float>(way * place[a]);
  }
  fit.store.setSides(sides);
  std::uint64_t wrong = 0;
  for (const std::uint32_t i : fit.surface.leaves()) {
    const SLIMSurface& s = fit.surface;
    const Vector3 p = along(s.info.origin, s.info.scale, {s.cx[i], s.cy[i], s.cz[i]});
    const bool outward = dot(p, {s.nx[i], s.ny[i], s.nz[i]}) > 0;
    if (outward == isInPatch(p)) fit.surface.flip(i);
    wrong += isInPatch(p) ? 1 : 0;
  }
  ASSERT_GT(wrong, 5u);
  EXPECT_EQ(turnContradicted({}, 2, fit.store, fit.surface), wrong);
  EXPECT_GT(turnedOutward(fit.surface, fit.store), 0.995);
  EXPECT_EQ(turnContradicted({}, 1, fit.store, fit.surface), 0u) << "nothing contradicts any more";
}

/** Two plates so near to each other that each leaf overlaps leaves of the other side. */
TEST(ContradictedSides, SidesOfThinPlatesStay) {
  for (const double gap : {1.5, 3.0}) {
    pcl_slim_test::Cloud cloud;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> along(0, 70);
    std::normal_distribution<double> noise(0, 0.1);
    for (int i = 0; i < 10000; ++i) {
      const double x = along(random), y = along(random), z = (i % 2 == 0 ? 0 : gap);
      const double h = noise(random);
      cloud.add(x, y, z + h);
    }
    PointStore kept = pcl_slim_test::storeOf(cloud);
    SLIMSurface surface;
    FitParams params;
    params.threads = 1;
    ASSERT_FALSE(fitSurface(kept, params, surface, nullptr, nullptr));
    ASSERT_TRUE(kept.hasSides());
    EXPECT_EQ(turnContradicted({}, 1, kept, surface), 0u) << gap;
  }
}

}  // namespace

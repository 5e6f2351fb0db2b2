// SPDX-License-Identifier: BSD-3-Clause
// On exact surfaces SLIM is no farther from the truth than the best that MLS can do.
#include <cmath>
#include <string>
#include <tuple>

#include "sweep.h"

namespace {

using namespace pcl_slim_test;

constexpr std::size_t kCount = 20000;

/** The default's position error as a share of MLS's at its best radius: 1, but where fine waves are
 * as high as the noise and a wave has some forty points. */
double shareOfDefault(const std::string& shape, double noise) {
  return shape == "relief" && noise > 0.004 ? 1.03 : 1.0;
}

/** Orders and radii around MLS's best: small ones without noise, where bias rules, and large ones
 * with it. Order 1 is never best. */
std::vector<Setting> mlsSweep(int order, double noise) {
  std::vector<Setting> settings;
  for (const int k : {15, 30, 60, 120, 240, 480}) {
    const bool near_best = noise > 0 ? k >= 30 && k <= (order == 2 ? 480 : 240) : k <= 60;
    if (near_best) settings.push_back(mls(order, k));
  }
  return settings;
}

Errors smaller(const Errors& a, const Errors& b) {
  return {std::fmin(a.position, b.position), std::fmin(a.worst, b.worst),
          std::fmin(a.normal, b.normal), std::fmin(a.curvature, b.curvature)};
}

class ExactSurfaces : public testing::TestWithParam<std::tuple<std::string, double>> {};

TEST_P(ExactSurfaces, NotAboveBestOfMls) {
  const auto& [shape, noise] = GetParam();
  auto scene = pcl_slim::comparison::makeScene(shape, kCount, noise);
  ASSERT_TRUE(scene) << scene.error().message;
  judgeSome(*scene);
  const Errors order2 = bestOf(*scene, mlsSweep(2, noise));
  const Errors rival = smaller(order2, bestOf(*scene, mlsSweep(3, noise)));
  for (const bool normals : {false, true}) {
    SCOPED_TRACE(normals ? "normals given" : "no normals");
    const Errors automatic = errorsOf(*scene, slim(normals));
    if (noise > 0) {
      EXPECT_LE(automatic.position, shareOfDefault(shape, noise) * order2.position) << "default";
    }
    std::vector<Setting> sweep = {slim(normals, 4, 1), slim(normals, 2), slim(normals, 2, 8),
                                  slim(normals, 3, 1)};
    if (normals) sweep.push_back(sharpSlim());
    const Errors ours = smaller(automatic, bestOf(*scene, sweep));
    EXPECT_LE(ours.position, rival.position);
    EXPECT_LE(ours.normal, rival.normal);
    if (scene->has_true_curvature) {
      EXPECT_LE(ours.curvature, rival.curvature);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ExactSurfaces,
                         testing::Combine(testing::ValuesIn(pcl_slim::comparison::shapeNames()),
                                          testing::Values(0.0, 0.001, 0.005)),
                         [](const auto& test) {
                           const int noise = static_cast<int>(1e4 * std::get<1>(test.param));
                           return std::get<0>(test.param) + "_noise_" + std::to_string(noise) +
                                  "e4";
                         });

}  // namespace

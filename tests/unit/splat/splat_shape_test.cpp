// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <random>

#include "painted_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

// Seven points in a row of shades, alone among points 50 times as far apart: their disc reaches far
// beyond them, and the shades must not go on as far.
TEST(SplatShape, GradientsEndNearTheirPoints) {
  PaintedCloud cloud;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      if (i == 6 && j == 6) continue;
      cloud.add({i + 0.5, j + 0.5, 0.0}, {0, 0, 1}, {128, 128, 128});
    }
  }
  const double middle[2] = {6.5, 6.5};
  for (int k = -3; k <= 3; ++k) {
    cloud.add({middle[0] + 0.02 * k, middle[1] + 0.02 * (k * k % 3 - 1), 0.0}, {0, 0, 1},
              {128 + 30 * k, 128 + 30 * k, 128 + 30 * k});
  }
  SplatParams params;
  params.color = SplatColor::kGradient;
  params.initial_resolution = 12;
  params.max_depth = 0;
  params.remove_noise = false;
  const SplatSet splats = sampled(cloud, params);
  std::size_t shaded = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const SplatSet::Gradient& g = splats.gradient[i];
    const double slope = std::hypot(g[0], g[1], g[2]);
    if (!(slope > 0.0)) continue;
    ++shaded;
    EXPECT_GT(splats.radius[i], 0.3f) << "the disc does not reach beyond its points";
    // The shades differ by 90 from the middle to the end; twice that, and a fifth for the curve
    // that codes light as colour.
    EXPECT_LT(slope * splats.radius[i], 2.2 * 90.0);
    EXPECT_GT(slope * splats.radius[i], 90.0);
  }
  EXPECT_EQ(shaded, 1u);
}

// A black bar beside a large motley floor: a budget has more to gain from the floor, and still must
// not make the bar a few discs that stand out of it.
TEST(SplatShape, BudgetsLeaveThinBarsTheirShape) {
  PaintedCloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  const double bar = 0.05;
  for (int i = 0; i < 40000; ++i) {
    const double x = 2.0 * uniform(random), y = 2.0 * uniform(random);
    const bool light = (static_cast<int>(37 * x) * 7 + static_cast<int>(41 * y) * 13) % 5 < 2;
    const int shade = light ? 215 : 95;
    cloud.add({x, y, 0.0}, {0, 0, 1}, {shade, shade, 90});
  }
  for (int i = 0; i < 6000; ++i) {
    const double angle = 6.283185307179586 * uniform(random);
    const std::array<double, 3> n = {0.0, std::cos(angle), std::sin(angle)};
    cloud.add({2.0 * uniform(random), 1.0 + bar * n[1], 0.5 + bar * n[2]}, n, {10, 10, 10});
  }
  SplatParams params;
  params.max_splats = 2300;
  const SplatSet splats = sampled(cloud, params);
  std::size_t of_bar = 0, standing_out = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const double z = splats.origin[2] + splats.z[i];
    if (z < 0.25) continue;
    ++of_bar;
    standing_out += splats.normal_variance[i] > 0.25f;
  }
  EXPECT_GT(of_bar, 100u);
  EXPECT_LT(standing_out, of_bar / 20);
}

}  // namespace
}  // namespace pcl_slim

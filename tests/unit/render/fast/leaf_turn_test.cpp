// SPDX-License-Identifier: BSD-3-Clause
// Leaves known to fall or rise along every ray, beside their polynomials; and the clock of stages.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "fast/fast_rasterizer.h"
#include "fast/setup/leaf_setup.h"
#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;
using detail::FrameLeaf;
using detail::LeafTurn;

/** \brief Leaves in front of a camera at the origin that looks along z, with random normals. */
SLIMSurface randomLeaves(std::size_t count, double bend, std::mt19937& random) {
  std::normal_distribution<double> normal;
  SLIMSurface surface;
  surface.info.degree = 4;
  surface.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    double n[3] = {normal(random), normal(random), normal(random)};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    surface.cx[i] = static_cast<float>(0.5 * normal(random));
    surface.cy[i] = static_cast<float>(0.5 * normal(random));
    surface.cz[i] = 4.0f;
    surface.nx[i] = static_cast<float>(n[0] / length);
    surface.ny[i] = static_cast<float>(n[1] / length);
    surface.nz[i] = static_cast<float>(n[2] / length);
    surface.radius[i] = i % 2 == 0 ? 0.05f : 1.0f;
    surface.degree[i] = 4;
    surface.flags[i] = kSurfelLeaf;
    float* c = surface.coefficients.data() + i * static_cast<std::size_t>(surface.stride());
    for (int k = 0; k < 15; ++k) c[k] = static_cast<float>(bend * normal(random));
  }
  return surface;
}

/** \brief f of a surfel at a point of the camera's axes, in radii. */
double heightOver(const SLIMSurface& surface, const FrameLeaf& leaf,
                  const std::array<double, 3>& center, const std::array<double, 3>& p) {
  double u = 0.0, v = 0.0, w = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = (p[a] - center[a]) / leaf.radius;
    u += leaf.u[a] * x;
    v += leaf.v[a] * x;
    w += leaf.w[a] * x;
  }
  const float* c = surface.coefficientsOf(leaf.surfel);
  for (int n = 0, k = 0; n <= 4; ++n) {
    for (int j = 0; j <= n; ++j, ++k) w -= double{c[k]} * std::pow(u, n - j) * std::pow(v, j);
  }
  return w;
}

/** \brief Expects that f changes along random rays through a share of the ball as its turn says. */
void expectTurn(const SLIMSurface& surface, const FrameLeaf& leaf, double share,
                std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double z = leaf.depth, reach = share * leaf.radius;
  const std::array<double, 3> center{leaf.xc * z, leaf.yc * z, z};
  const double sign = leaf.turn == LeafTurn::kFalls ? -1.0 : 1.0;
  const auto inside = [&](const std::array<double, 3>& p) {
    return std::hypot(p[0] - center[0], p[1] - center[1], p[2] - center[2]) < reach;
  };
  for (int ray = 0; ray < 40; ++ray) {
    std::array<double, 3> p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = center[a] + reach * uniform(random);
    if (!inside(p)) continue;
    bool started = false;
    double last = 0.0;
    for (int step = -40; step <= 40; ++step) {
      const double t = 1.0 + step / 40.0 * 2.0 * reach / p[2];
      const std::array<double, 3> at{t * p[0], t * p[1], t * p[2]};
      if (!inside(at)) continue;
      const double value = heightOver(surface, leaf, center, at);
      if (started) {
        EXPECT_GT(sign * (value - last), 0.0) << "surfel " << leaf.surfel;
      }
      started = true;
      last = value;
    }
  }
}

TEST(LeafTurns, HoldAlongEveryRay) {
  std::mt19937 random(7);
  Camera camera;
  camera.position = {0.0, 0.0, 0.0};
  camera.look_at = {0.0, 0.0, 1.0};
  camera.up = {0.0, 1.0, 0.0};
  camera.size = {200, 200};
  const detail::BallShares shares{0.7f, 0.9f};
  for (const double bend : {0.02, 0.15}) {
    const SLIMSurface surface = randomLeaves(256, bend, random);
    const detail::FrameView view(camera, surface.info.origin, surface.info.scale);
    const std::size_t stride = detail::leafStride(4);
    AlignedVector<std::uint8_t> records(surface.size() * stride);
    const auto leaf = [&](std::size_t i) {
      return reinterpret_cast<FrameLeaf*>(records.data() + i * stride);
    };
    detail::BatchFiller filler(surface, view, shares);
    for (std::uint32_t i = 0; i < surface.size(); ++i) filler.add(i, 1.0f, {}, leaf(i));
    filler.flushAll();
    std::size_t known = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (leaf(i)->turn == LeafTurn::kEither) continue;
      ++known;
      expectTurn(surface, *leaf(i), shares.first, random);
    }
    EXPECT_GT(known, bend < 0.1 ? surface.size() * 2 / 3 : surface.size() / 20);
  }
}

TEST(FrameStages, AreCountedWithoutChangingThePicture) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 2000, 0.03);
  const Camera camera = frontCamera(64, 64);
  RenderParams params;
  params.threads = 2;
  const detail::FrameRules rules(surface.info, params);
  detail::FastRasterizer rasterizer(surface, 2);
  GBuffer plain, timed;
  for (GBuffer* buffer : {&plain, &timed}) buffer->reserve(64, 64, 0);
  RenderStatistics counts;
  rasterizer.draw(camera, rules, 0, plain, counts);
  detail::StageTicks ticks;
  rasterizer.draw(camera, rules, 0, timed, counts, &ticks);
  expectSame(plain, timed);
  for (const std::uint64_t stage : ticks.of) EXPECT_GT(stage, 0u);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes of bodies whose leaves stand off one another have no hairs; thin parts keep theirs.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/surface/polynomial.h"
#include "support/clouds.h"
#include "unit/render/sphere_view.h"
#include "unit/render/tracer/traced_scenes.h"

namespace pcl_slim {
namespace {

using namespace test;

using Mask = std::vector<std::uint8_t>;

Mask maskOf(const GBuffer& buffer) {
  Mask mask(buffer.numPixels());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = buffer.covered(i) ? 1 : 0;
  return mask;
}

/** The mask with all pixels within two pixels of those of a value set to it. */
Mask spread(const GBuffer& buffer, const Mask& mask, std::uint8_t value) {
  Mask result = mask;
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      for (int j = std::max(0, y - 2); j <= std::min(buffer.height - 1, y + 2); ++j) {
        for (int i = std::max(0, x - 2); i <= std::min(buffer.width - 1, x + 2); ++i) {
          const int away = (i - x) * (i - x) + (j - y) * (j - y);
          if (away <= 4 && mask[buffer.index(i, j)] == value) result[buffer.index(x, y)] = value;
        }
      }
    }
  }
  return result;
}

/** Drawn pixels (1), or others (0), that no disc of radius 2 of their kind contains: hairs, dashes
 * and specks, or slits and pinholes. */
std::size_t hairs(const GBuffer& buffer, std::uint8_t kind) {
  const auto other = static_cast<std::uint8_t>(1 - kind);
  const Mask mask = maskOf(buffer), open = spread(buffer, spread(buffer, mask, other), kind);
  std::size_t count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    count += mask[i] == kind && open[i] != kind ? 1 : 0;
  }
  return count;
}

/** A unit sphere fitted to points with noise of .035. */
SLIMSurface noisySphere() {
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0.0, 1.0);
  pcl_slim_test::Cloud cloud;
  for (int i = 0; i < 20000; ++i) {
    Vector3 p;
    for (double& x : p) x = normal(random);
    const double scale = (1.0 + 0.035 * normal(random)) / length(p);
    cloud.add(scale * p[0], scale * p[1], scale * p[2]);
  }
  return pcl_slim_test::fitted(cloud).surface;
}

GBuffer traced(const SLIMSurface& surface, const Camera& camera) {
  GBuffer buffer;
  LightBuffer light;
  RayTracer tracer(surface);
  const Error error = tracer.trace(camera, TraceParams(), buffer, light);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

// A leaf that a ray meets alone, beyond the outline of all others, was drawn as a hair.
TEST(Silhouette, OfANoisyBodyHasNoHairs) {
  const SLIMSurface surface = noisySphere();
  Camera camera;
  camera.up = {0.0, 0.0, 1.0};
  camera.size = {900, 900};
  camera.position = {4.5, 0.0, 2.0};
  RenderParams params;
  params.close_gaps = true;
  for (const GBuffer& buffer : {rendered(surface, camera, params), traced(surface, camera)}) {
    EXPECT_GT(buffer.numCovered(), 300000u);
    EXPECT_LE(hairs(buffer, 1), 4u);  // of 2000 along the outline
    EXPECT_LE(hairs(buffer, 0), 4u);
  }
}

// A wire thinner than its leaves' balls: all around it leaves face away from one another, and those
// of the other side are within every ball.
TEST(Silhouette, OfAThinWireStaysWhereItIs) {
  constexpr double kWire = 0.02, kBall = 0.03, kStep = 0.008;
  SLIMSurface surface = emptySurface(2);
  for (int i = -40; i <= 40; ++i) {
    for (int k = 0; k < 16; ++k) {
      const double angle = std::acos(-1.0) * (k + 0.5 * (i & 1)) / 8.0;
      const Vector3 n{0.0, std::cos(angle), std::sin(angle)};
      const LocalFrame frame(n);
      float* c = addLeaf(surface, {kStep * i, kWire * n[1], kWire * n[2]}, n, kBall);
      const double bend = -kBall / (2.0 * kWire);  // across the wire, whose direction is x
      c[3] = static_cast<float>(bend * (1.0 - frame.u[0] * frame.u[0]));
      c[4] = static_cast<float>(-2.0 * bend * frame.u[0] * frame.v[0]);
      c[5] = static_cast<float>(bend * (1.0 - frame.v[0] * frame.v[0]));
    }
  }
  Camera camera = frontCamera(300, 300);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.3;
  const GBuffer buffer = rendered(surface, camera, {});
  for (int x = 0; x < 300; ++x) {
    int drawn = 0;
    for (int y = 0; y < 300; ++y) drawn += buffer.covered(buffer.index(x, y)) ? 1 : 0;
    // A parabola instead of a circle: leaves whose middle is at the outline meet it exactly.
    EXPECT_NEAR(drawn, 2.0 * kWire / 0.001, 2.0) << x;
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes of bodies whose leaves stand off one another have no hairs; thin parts keep theirs.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/surface/polynomial.h"
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

/** The mask without the pixels (with all those) that have one of value 0 (1) within two pixels. */
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

/** Drawn pixels that no disc of radius 2 within the drawn ones contains: hairs, dashes and specks. */
std::size_t hairs(const GBuffer& buffer) {
  const Mask mask = maskOf(buffer), open = spread(buffer, spread(buffer, mask, 0), 1);
  std::size_t count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) count += mask[i] && !open[i] ? 1 : 0;
  return count;
}

/** Leaves of a sphere, each moved along its normal and tilted at random, as noise moves them. */
SLIMSurface noisySphere(double amount) {
  SLIMSurface surface = sphereSurface(2, kSphere, 900, 0.06);
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0.0f, static_cast<float>(amount));
  for (std::size_t i = 0; i < surface.size(); ++i) {
    float* c = surface.coefficients.data() + i * static_cast<std::size_t>(surface.stride());
    for (int k = 0; k < 3; ++k) c[k] += normal(random);
  }
  return surface;
}

GBuffer traced(const SLIMSurface& surface, const Camera& camera) {
  GBuffer buffer;
  LightBuffer light;
  RayTracer tracer(surface);
  const Error error = tracer.trace(camera, TraceParams(), buffer, light);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

// The outline is the exact one but for the leaves' errors: .02 radii of height and as much slope give
// an RMS error of .02 r (1 + 1/2) or .0018, which is 1.1 pixels; three times that and a pixel.
TEST(Silhouette, OfANoisyBodyHasNoHairs) {
  const SLIMSurface surface = noisySphere(0.02);
  Camera camera = frontCamera(400, 400);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.66;
  const double pixel = camera.view_height / 400, tolerance = 4.3 * pixel;
  for (const GBuffer& buffer : {rendered(surface, camera, {}), referenceFrame(surface, camera, {}),
                                traced(surface, camera)}) {
    EXPECT_EQ(hairs(buffer), 0u);
    for (int y = 0; y < 400; ++y) {
      for (int x = 0; x < 400; ++x) {
        const double away = std::hypot((x - 199.5) * pixel, (y - 199.5) * pixel) - kSphere;
        if (std::abs(away) < tolerance) continue;
        ASSERT_EQ(buffer.covered(buffer.index(x, y)), away < 0.0) << x << " " << y;
      }
    }
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

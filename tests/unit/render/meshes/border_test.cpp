// SPDX-License-Identifier: BSD-3-Clause
// The picture of a surface and that of its mesh end at the same border.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/render/mesh_renderer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

constexpr int kPoints = 8000, kSize = 500;

struct Scene {
  const char* name;
  double border;                                        ///< its length
  double spacing;                                       ///< sqrt(area / points)
  std::function<bool(double, double, Vector3&)> point;  ///< from two numbers of [-1, 1); or none
};

std::vector<Scene> scenes() {
  const double pi = std::acos(-1.0), step = 2.0 / std::sqrt(double{kPoints});
  const auto hole = [](double x, double y, Vector3& p) {
    p = {x, y, 0.0};
    return std::hypot(x - 0.2, y + 0.1) > 0.3;
  };
  // Waves with 3 x 3 holes of 12 spacings.
  const auto sieve = [step](double x, double y, Vector3& p) {
    p = {x, y, 0.05 * std::sin(5.0 * x) * std::cos(4.0 * y)};
    const auto away = [](double t) { return t - 0.6 * std::round(t / 0.6); };
    return std::hypot(away(x), away(y)) > 6.0 * step;
  };
  const auto cut = [pi](double x, double y, Vector3& p) {
    const double z = 0.75 * y - 0.25, rho = std::sqrt(1.0 - z * z);  // up to z = .5
    p = {rho * std::cos(pi * x), rho * std::sin(pi * x), z};
    return true;
  };
  return {{"hole", 8.0 + 0.6 * pi, step, hole},
          {"sieve", 8.0 + 9.0 * 12.0 * pi * step, step, sieve},
          {"cut sphere", 2.0 * pi * std::sqrt(0.75), std::sqrt(3.0 * pi / kPoints), cut}};
}

SLIMSurface surfaceOf(const Scene& scene) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  pcl_slim_test::Cloud cloud;
  Vector3 p;
  while (cloud.size() < kPoints) {
    const double a = uniform(random), b = uniform(random);
    if (scene.point(a, b, p)) cloud.add(p[0], p[1], p[2]);
  }
  return pcl_slim_test::fitted(cloud).surface;
}

/** Whether two masks differ at a pixel and all about it, at most reach pixels away. */
bool differsAllAbout(const GBuffer& a, const GBuffer& b, int x, int y, int reach) {
  for (int j = std::max(0, y - reach); j <= std::min(kSize - 1, y + reach); ++j) {
    for (int i = std::max(0, x - reach); i <= std::min(kSize - 1, x + reach); ++i) {
      if (a.covered(a.index(i, j)) == b.covered(a.index(i, j))) return false;
    }
  }
  return true;
}

TEST(Border, OfThePictureIsThatOfTheMesh) {
  for (const Scene& scene : scenes()) {
    const SLIMSurface surface = surfaceOf(scene);
    TriangleMesh mesh;
    ASSERT_FALSE(extractMesh(surface, MeshParams(), mesh)) << scene.name;
    Camera camera;
    camera.position = {0.0, -1.5, 5.0};
    camera.size = {kSize, kSize};
    camera.projection = Camera::Projection::kOrthographic;
    camera.view_height = 2.6;
    const double spacing = scene.spacing * kSize / camera.view_height;  // pixels
    GBuffer picture, meshed;
    ASSERT_FALSE(renderSurface(surface, camera, RenderParams(), picture));
    ASSERT_FALSE(renderMesh(mesh, camera, MeshRenderParams(), 0, meshed));
    std::size_t differing = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const std::size_t i = picture.index(x, y);
        if (picture.covered(i) == meshed.covered(i)) continue;
        ++differing;
        // Twice 1.5 spacings wide nowhere.
        EXPECT_FALSE(differsAllAbout(picture, meshed, x, y, static_cast<int>(1.5 * spacing)))
            << scene.name << " " << x << " " << y;
      }
    }
    // Of the border and, as of the cut sphere, the outline: half a pixel of it by rounding.
    const double border = scene.border * kSize / camera.view_height;
    EXPECT_LE(static_cast<double>(differing), 0.25 * spacing * border) << scene.name;
    EXPECT_GT(picture.numCovered(), 20000u) << scene.name;
  }
}

}  // namespace
}  // namespace pcl_slim

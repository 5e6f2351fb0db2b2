// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/mesh_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pcl_slim/core/vector3.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;

constexpr double kBall = 0.25;

/** A sphere of squares cut in two, with exact normals and curvatures. */
TriangleMesh sphereMesh(std::uint32_t rows) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= rows; ++i) {
    for (std::uint32_t j = 0; j < 2 * rows; ++j) {
      const double down = M_PI * i / rows, turn = M_PI * j / rows;
      const Vector3 n{std::sin(down) * std::cos(turn), std::sin(down) * std::sin(turn),
                      std::cos(down)};
      mesh.vertices.push_back(scaled(n, kBall));
      mesh.normals.push_back(
          {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
      mesh.k1.push_back(static_cast<float>(1 / kBall));
      mesh.k2.push_back(static_cast<float>(1 / kBall));
    }
  }
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < 2 * rows; ++j) {
      const std::uint32_t a = 2 * rows * i + j, b = 2 * rows * i + (j + 1) % (2 * rows);
      mesh.triangles.push_back({a, a + 2 * rows, b + 2 * rows});
      mesh.triangles.push_back({a, b + 2 * rows, b});
    }
  }
  return mesh;
}

/** The six faces of a cube of side 1, whose corners share the diagonals as normals. */
TriangleMesh cubeMesh() {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Vector3 corner{(i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2 & 1) - 0.5};
    const Vector3 n = normalized(corner);
    mesh.vertices.push_back(corner);
    mesh.normals.push_back(
        {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    mesh.colors.push_back({static_cast<std::uint8_t>(255 * (i & 1)), 0, 0});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Camera lookingFrom(const Vector3& position, Camera::Projection projection) {
  Camera camera;
  camera.position = position;
  camera.up = {0, 0, 1};
  camera.size = {97, 64};
  camera.projection = projection;
  camera.view_height = 1.0;
  return camera;
}

GBuffer drawn(const TriangleMesh& mesh, const Camera& camera, VisibleSides sides, int threads = 1) {
  MeshRenderParams params;
  params.sides = sides;
  params.threads = threads;
  GBuffer buffer;
  const Error error = renderMesh(mesh, camera, params, kAllColumns, buffer);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

TEST(MeshRenderer, ASphereIsWhereRaysMeetIt) {
  const TriangleMesh mesh = sphereMesh(200);
  for (const auto projection :
       {Camera::Projection::kPerspective, Camera::Projection::kOrthographic}) {
    const Camera camera = lookingFrom({0.4, -1.1, 0.5}, projection);
    const GBuffer buffer = drawn(mesh, camera, VisibleSides::kAuto);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
      if (!buffer.covered(i)) continue;
      ++covered;
      const auto &p = buffer.position[i], &n = buffer.normal[i];
      EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), kBall, 4e-5);
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(n[a], p[a] / kBall, 2e-3);
      EXPECT_NEAR(buffer.mean_curvature[i], 1 / kBall, 1e-3);
      EXPECT_NEAR(buffer.gaussian_curvature[i], 1 / kBall / kBall, 1e-2);
    }
    EXPECT_GT(covered, 500u);
  }
}

TEST(MeshRenderer, PicturesEqualThoseOfTheSurface) {
  const SLIMSurface surface = sphereSurface(4, kBall, 600, 0.07);
  const Camera camera = lookingFrom({0.4, -1.1, 0.5}, Camera::Projection::kPerspective);
  ShadingParams shading;
  shading.supersampling = 1;
  const auto of_mesh = renderPicture(sphereMesh(200), camera, MeshRenderParams(), shading);
  const auto of_surface = renderPicture(surface, camera, RenderParams(), shading);
  ASSERT_TRUE(of_mesh && of_surface);
  const GBuffer buffer = drawn(sphereMesh(200), camera, VisibleSides::kAuto);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    for (std::size_t c = 0; c < 3; ++c)
      sum += std::abs(of_mesh->rgb[3 * i + c] - of_surface->rgb[3 * i + c]);
    count += 3;
  }
  EXPECT_LT(sum / count, 1.0);
}

TEST(MeshRenderer, EdgesStaySharpAndColorsAreInterpolated) {
  const Camera camera = lookingFrom({0, -3, 0}, Camera::Projection::kOrthographic);
  const GBuffer buffer = drawn(cubeMesh(), camera, VisibleSides::kFront);
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    EXPECT_EQ(buffer.normal[i], (std::array<float, 3>{0.0f, -1.0f, 0.0f}));
    EXPECT_NEAR(buffer.color[i][0], buffer.position[i][0] + 0.5, 1e-5);
  }
}

TEST(MeshRenderer, FrontsAloneLeaveOutTheNearSideOfWhatFacesInwards) {
  TriangleMesh room = cubeMesh();
  for (auto& t : room.triangles) std::swap(t[1], t[2]);
  const Camera camera = lookingFrom({0, -3, 0}, Camera::Projection::kPerspective);
  const GBuffer outside = drawn(room, camera, VisibleSides::kBoth);
  const GBuffer inside = drawn(room, camera, VisibleSides::kFront);
  const std::size_t middle = inside.index(48, 32);
  EXPECT_NEAR(outside.position[middle][1], -0.5, 1e-6);
  EXPECT_EQ(outside.back_face[middle], 1);
  EXPECT_NEAR(inside.position[middle][1], 0.5, 1e-6);
  EXPECT_EQ(inside.back_face[middle], 0);
}

TEST(MeshRenderer, ThreadsChangeNothing) {
  const Camera camera = lookingFrom({0.4, -1.1, 0.5}, Camera::Projection::kPerspective);
  const GBuffer one = drawn(sphereMesh(40), camera, VisibleSides::kAuto, 1);
  const GBuffer four = drawn(sphereMesh(40), camera, VisibleSides::kAuto, 4);
  EXPECT_EQ(one.depth, four.depth);
  EXPECT_EQ(one.surfel, four.surfel);
  EXPECT_EQ(one.normal, four.normal);
}

TEST(MeshRenderer, IsCutRayByRay) {
  const Camera camera = lookingFrom({0, -3, 0}, Camera::Projection::kOrthographic);
  MeshRenderParams params;
  params.cuts = {{{1, 0, 0}, 0.1}, {{0, 0, -1}, -0.2}};
  GBuffer buffer;
  ASSERT_FALSE(renderMesh(cubeMesh(), camera, params, kAllColumns, buffer));
  const GBuffer whole = drawn(cubeMesh(), camera, VisibleSides::kAuto);
  for (std::size_t i = 0; i < whole.numPixels(); ++i) {
    if (!whole.covered(i)) continue;
    const auto& p = whole.position[i];
    EXPECT_EQ(buffer.covered(i), p[0] >= 0.1f && p[2] <= 0.2f);
  }
}

TEST(MeshRenderer, BlocksLeaveOutNothing) {
  // Long thin triangles about a middle, against each pixel's own angle and radius.
  constexpr std::uint32_t kSides = 90;
  TriangleMesh disc;
  disc.vertices.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double turn = 2 * M_PI * i / kSides;
    disc.vertices.push_back({0.45 * std::cos(turn), 0.0, 0.45 * std::sin(turn)});
    disc.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSides});
  }
  for (const auto projection :
       {Camera::Projection::kPerspective, Camera::Projection::kOrthographic}) {
    const Camera camera = lookingFrom({0.3, -2, 0.4}, projection);
    const GBuffer buffer = drawn(disc, camera, VisibleSides::kAuto);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < buffer.numPixels(); ++i) covered += buffer.covered(i);
    TriangleMesh square;  // that the disc is part of
    square.vertices = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    const GBuffer all = drawn(square, camera, VisibleSides::kAuto);
    for (std::size_t i = 0; i < all.numPixels(); ++i) {
      if (!all.covered(i)) continue;
      const double r = std::hypot(all.position[i][0], all.position[i][2]);
      EXPECT_TRUE(buffer.covered(i) || r > 0.449) << i;
      EXPECT_TRUE(!buffer.covered(i) || r < 0.4501) << i;
    }
    EXPECT_GT(covered, 500u);
  }
}

TEST(MeshRenderer, RefusesWhatIsNoMeshAndWhatAMeshHasNot) {
  const Camera camera = lookingFrom({0, -3, 0}, Camera::Projection::kPerspective);
  GBuffer buffer;
  TriangleMesh mesh = cubeMesh();
  mesh.triangles[3][1] = 8;
  EXPECT_TRUE(renderMesh(mesh, camera, {}, kAllColumns, buffer));
  EXPECT_EQ(buffer.numPixels(), 0u);
  mesh = cubeMesh();
  mesh.vertices[5][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(renderMesh(mesh, camera, {}, kAllColumns, buffer));
  mesh = cubeMesh();
  mesh.k1.assign(8, std::numeric_limits<float>::quiet_NaN());
  mesh.k2.assign(8, 1.0f);
  ASSERT_FALSE(renderMesh(mesh, camera, {}, kAllColumns, buffer));
  EXPECT_EQ(buffer.mean_curvature[buffer.index(48, 32)], 0.0f);
  mesh = cubeMesh();
  mesh.normals.pop_back();
  EXPECT_TRUE(renderMesh(mesh, camera, {}, kAllColumns, buffer));
  ShadingParams shading;
  for (const ShadingMode mode : {ShadingMode::kMean, ShadingMode::kLevel, ShadingMode::kError}) {
    shading.mode = mode;
    EXPECT_FALSE(renderPicture(cubeMesh(), camera, MeshRenderParams(), shading));
  }
  shading.mode = ShadingMode::kColor;
  EXPECT_TRUE(renderPicture(cubeMesh(), camera, MeshRenderParams(), shading));
  EXPECT_FALSE(renderPicture(sphereMesh(8), camera, MeshRenderParams(), shading));
  EXPECT_TRUE(renderPicture(TriangleMesh(), camera, MeshRenderParams(), ShadingParams()));
}

}  // namespace
}  // namespace pcl_slim

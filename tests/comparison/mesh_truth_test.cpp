// SPDX-License-Identifier: BSD-3-Clause
// Distances to meshes against brute force and known shapes, and scans judged by one.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>

#include "comparison/mesh_surface.h"
#include "support/temporary_folder.h"
#include "sweep.h"

namespace {

using namespace pcl_slim_test;
using pcl_slim::comparison::loadScene;
using pcl_slim::comparison::MeshSurface;
using Point = MeshSurface::Point;

/** A square of n x n cells, two triangles each, in the plane z = 0 over [0, n]^2. */
MeshSurface square(std::uint32_t n) {
  std::vector<Point> vertices;
  std::vector<MeshSurface::Triangle> triangles;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      vertices.push_back({static_cast<double>(x), static_cast<double>(y), 0});
      if (x == n || y == n) continue;
      const std::uint32_t a = y * (n + 1) + x, b = a + n + 1;
      triangles.push_back({a, a + 1, b});
      triangles.push_back({a + 1, b + 1, b});
    }
  }
  return MeshSurface(vertices, triangles);
}

TEST(MeshTruth, DistancesAreThoseOfASampledTriangleSoup) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  const auto any = [&] { return Point{place(random), place(random), place(random)}; };
  std::vector<Point> vertices;
  std::vector<MeshSurface::Triangle> triangles;
  for (std::uint32_t t = 0; t < 40; ++t) {
    for (int k = 0; k < 3; ++k) vertices.push_back(any());
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const MeshSurface mesh(vertices, triangles);
  constexpr int kSteps = 60;
  for (int trial = 0; trial < 20; ++trial) {
    const Point p = any();
    double least = 1e9;
    for (const auto& t : triangles) {
      for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; i + j <= kSteps; ++j) {
          double sum = 0;
          for (std::size_t a = 0; a < 3; ++a) {
            const double q = (i * vertices[t[0]][a] + j * vertices[t[1]][a] +
                              (kSteps - i - j) * vertices[t[2]][a]) /
                             kSteps;
            sum += (p[a] - q) * (p[a] - q);
          }
          least = std::min(least, std::sqrt(sum));
        }
      }
    }
    const double found = mesh.nearest(p).distance;
    EXPECT_LE(found, least + 1e-12);
    // No place of a triangle is farther from a sample than a step of its longest side, 3.5.
    EXPECT_GE(found, least - 3.5 / kSteps);
  }
}

TEST(MeshTruth, BorderIsWhereOneTriangleEnds) {
  const MeshSurface mesh = square(8);
  const auto inside = mesh.nearest({4, 4, 0.5});
  EXPECT_DOUBLE_EQ(inside.distance, 0.5);
  EXPECT_FALSE(inside.border);
  EXPECT_TRUE(mesh.nearest({-1, 4.3, 0}).border);
  EXPECT_TRUE(mesh.nearest({9, 9, 1}).border);
  EXPECT_NEAR(mesh.nearest({9, 9, 1}).distance, std::sqrt(3.0), 1e-12);
  EXPECT_FALSE(mesh.nearest({0.1, 4, 2}).border);
}

TEST(MeshTruth, TrianglesWithoutAreaAreNoTrouble) {
  const MeshSurface mesh({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 0, 0}}, {{0, 1, 2}, {0, 3, 0}});
  EXPECT_DOUBLE_EQ(mesh.nearest({1.5, 3, 0}).distance, 3.0);
  EXPECT_DOUBLE_EQ(mesh.nearest({-4, 0, 3}).distance, 5.0);
}

class MeshTruthFiles : public testing::Test {
 protected:
  void SetUp() override {
    const char* head = "ply\nformat ascii 1.0\nelement vertex ";
    const char* xyz = "\nproperty double x\nproperty double y\nproperty double z\n";
    // Two triangles: the square [0, 4]^2 at z = 7, far from the origin.
    std::ofstream(mesh()) << head << 4 << xyz
                          << "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                          << "500000 0 7\n500004 0 7\n500004 4 7\n500000 4 7\n"
                          << "3 0 1 2\n3 0 2 3\n";
    std::ofstream(scan()) << head << 5 << xyz << "end_header\n"
                          << "500001 1 7.25\n500002 2 6.5\n500009 2 7\n500002 2 17\nnan 0 0\n";
  }
  std::string mesh() const { return folder_ / "mesh.ply"; }
  std::string scan() const { return folder_ / "scan.ply"; }

  pcl_slim_test::TemporaryFolder folder_;
};

TEST_F(MeshTruthFiles, PointsCountThatLieByTheSurface) {
  const auto scene = loadScene("scan", scan(), mesh());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->size(), 4u);
  const std::vector<bool> expected = {true, true, false, false};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scene->isJudged(i), expected[i]) << i;
  const Errors e = inputErrors(*scene);
  EXPECT_NEAR(e.position, std::sqrt((0.0625 + 0.25) / 2), 1e-6);
  EXPECT_NEAR(e.worst, 0.5, 1e-6);
}

TEST_F(MeshTruthFiles, AnotherPlaceIsRefused) {
  std::ofstream(scan()) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\n"
                        << "property double y\nproperty double z\nend_header\n0 0 0\n";
  const auto scene = loadScene("scan", scan(), mesh());
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("same object"), std::string::npos);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Border loops: which are closed, by what, and how many are left.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "borders/borders.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::Cloud;

std::vector<detail::BorderPiece> polygon(const std::vector<std::array<double, 2>>& corners) {
  std::vector<detail::BorderPiece> made;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    made.push_back({{a[0], a[1]}, {b[0], b[1]}});
  }
  return made;
}

TEST(WidestDisc, IsThatOfPolygonsWithAndWithoutIslands) {
  const double any = std::numeric_limits<double>::infinity();
  auto square = polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  EXPECT_NEAR(detail::widestDisc(square, 0, any), 4, 0.05);
  EXPECT_NEAR(detail::widestDisc(polygon({{0, 0}, {400, 0}, {400, 1}, {0, 1}}), 0, any), 1, 0.02);
  // Of an L with arms 2 wide the disc in the corner touches the inner corner: r = 4 - 2 sqrt 2.
  const auto bent = polygon({{0, 0}, {9, 0}, {9, 2}, {2, 2}, {2, 9}, {0, 9}});
  EXPECT_NEAR(detail::widestDisc(bent, 0, any), 2 * (4 - 2 * M_SQRT2), 0.03);
  const auto island = polygon({{1, 1}, {3, 1}, {3, 3}, {1, 3}});
  square.insert(square.end(), island.begin(), island.end());
  EXPECT_LT(detail::widestDisc(square, 0, any), 1.3) << "between square and island";
  EXPECT_GE(detail::widestDisc(bent, 0, 1), 1) << "ends where one is wide enough";
  EXPECT_EQ(detail::widestDisc(bent, 5, any), 5) << "none is larger";
  EXPECT_EQ(detail::widestDisc({}, 0, any), 0);
}

/** What is wrong with a mesh, beyond the census. */
struct Flaws {
  std::size_t flat = 0;    ///< triangles without area
  std::size_t spurs = 0;   ///< with two edges on the border, folded back onto the mesh
  std::size_t unused = 0;  ///< vertices
};

Flaws flawsOf(const TriangleMesh& mesh) {
  Flaws flaws;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> uses;
  std::vector<bool> used(mesh.vertices.size(), false);
  std::vector<Vector3> areas;
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& own = mesh.triangles[t];
    // As a file of floats has them.
    Vector3 p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t a = 0; a < 3; ++a)
        p[k][a] = static_cast<double>(static_cast<float>(mesh.vertices[own[k]][a]));
      uses[{own[k], own[(k + 1) % 3]}] = t;
      used[own[k]] = true;
    }
    areas.push_back(cross(subtract(p[1], p[0]), subtract(p[2], p[0])));
    sum += length(areas.back());
  }
  for (std::size_t t = 0; t < areas.size(); ++t) {
    if (!(length(areas[t]) > 1e-6 * sum / static_cast<double>(areas.size()))) ++flaws.flat;
    const auto& own = mesh.triangles[t];
    std::vector<std::size_t> across;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = uses.find({own[(k + 1) % 3], own[k]});
      if (at != uses.end()) across.push_back(at->second);
    }
    if (across.size() == 1 && dot(areas[t], areas[across[0]]) < 0) ++flaws.spurs;
  }
  flaws.unused = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  return flaws;
}

/** A noisy cloud whose mesh has borders or thin places. */
struct OpenScene {
  const char* name;
  std::int64_t watertight_euler;
  std::function<bool(std::mt19937_64&, Vector3&)> draw;  ///< false: the place is in a hole
  double noise = 0.1;                                    ///< spacings
  double spacing = 1;
};

void PrintTo(const OpenScene& scene, std::ostream* out) {
  *out << scene.name;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<OpenScene> openScenes() {
  const auto sheet = [](double side, double hole) {
    return [=](std::mt19937_64& random, Vector3& p) {
      const double x = uniform(random, 0, side), y = uniform(random, 0, side);
      p = {x, y, 4 * std::sin(x / 12)};
      return std::hypot(x - side / 2, y - side / 2) > hole;
    };
  };
  const auto ball = [](double holes) {
    return [=](std::mt19937_64& random, Vector3& p) {
      std::normal_distribution<double> gauss;
      for (double& x : p) x = gauss(random);
      p = scaled(normalized(p), 28);
      for (const double x : p) {
        if (std::abs(x) > 28 * std::cos(holes / 28)) return false;
      }
      return true;
    };
  };
  const auto pipe = [](std::mt19937_64& random, Vector3& p) {
    const double angle = uniform(random, 0, 2 * M_PI);
    p = {12 * std::cos(angle), 12 * std::sin(angle), uniform(random, 0, 130)};
    return true;
  };
  const auto bent = [](std::mt19937_64& random, Vector3& p) {
    const double x = uniform(random, 0, 100), y = uniform(random, 0, 100);
    p = {x, y, 0};
    return !(x > 30 && x < 70 && y > 30);  // a U
  };
  return {{"sheet with a hole", 2, sheet(100, 15)},
          {"noisy sheet with a hole", 2, sheet(100, 15), 0.5},
          {"ball with six holes of 20", 2, ball(10)},
          {"pipe", 2, pipe},
          {"U", 2, bent}};
}

class Borders : public testing::TestWithParam<OpenScene> {
 protected:
  SLIMSurface surface() const {
    Cloud cloud;
    std::mt19937_64 random(11);
    std::normal_distribution<double> gauss(0, GetParam().noise);
    for (int i = 0; i < 9800; ++i) {
      Vector3 p;
      if (GetParam().draw(random, p)) cloud.addNoisy(p, gauss, random);
    }
    return pcl_slim_test::fitted(cloud).surface;
  }
};

void expectSimple(const MeshCensus& census) {
  EXPECT_EQ(census.nonmanifold_edges, 0u);
  EXPECT_EQ(census.nonmanifold_vertices, 0u);
  EXPECT_EQ(census.turned_edges, 0u);
}

void expectNoFlaw(const TriangleMesh& mesh) {
  const Flaws flaws = flawsOf(mesh);
  EXPECT_EQ(flaws.flat, 0u);
  EXPECT_EQ(flaws.spurs, 0u);
  EXPECT_EQ(flaws.unused, 0u);
}

TEST_P(Borders, AreCountedAndAllClosedWhereTheMeshShallBeWatertight) {
  const SLIMSurface fitted = surface();
  TriangleMesh open, closed;
  MeshStatistics of_open, of_closed;
  ASSERT_FALSE(extractMesh(fitted, {}, open, &of_open));
  EXPECT_EQ(of_open.census.components, 1u);
  EXPECT_GT(of_open.border_loops, 0u);
  expectSimple(of_open.census);
  expectNoFlaw(open);
  MeshParams params;
  params.watertight = true;
  ASSERT_FALSE(extractMesh(fitted, params, closed, &of_closed));
  EXPECT_EQ(of_closed.census.border_edges, 0u);
  EXPECT_EQ(of_closed.border_loops, 0u);
  EXPECT_EQ(of_closed.closed_holes, of_open.closed_holes + of_open.border_loops);
  EXPECT_NEAR(of_closed.area - of_closed.closed_area, of_open.area - of_open.closed_area,
              0.01 * of_open.area);
  EXPECT_EQ(of_closed.census.euler, GetParam().watertight_euler);
  expectSimple(of_closed.census);
  expectNoFlaw(closed);
}

TEST_P(Borders, KeepTheirKindWhereTheMeshHasFewTriangles) {
  const SLIMSurface fitted = surface();
  TriangleMesh mesh;
  MeshStatistics whole, few;
  ASSERT_FALSE(extractMesh(fitted, {}, mesh, &whole));
  MeshParams params;
  params.max_triangles = mesh.triangles.size() / 3;
  ASSERT_FALSE(extractMesh(fitted, params, mesh, &few));
  EXPECT_EQ(few.border_loops, whole.border_loops);
  EXPECT_EQ(few.census.euler, whole.census.euler);
  expectSimple(few.census);
  expectNoFlaw(mesh);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Borders, testing::ValuesIn(openScenes()));

TEST(Holes, AreClosedAlongTheSurfaceAround) {
  const OpenScene scene = openScenes()[2];
  Cloud cloud;
  std::mt19937_64 random(2);
  for (int i = 0; i < 9800; ++i) {
    Vector3 p;
    if (scene.draw(random, p)) cloud.add(p[0], p[1], p[2]);
  }
  MeshParams params;
  params.watertight = true;
  TriangleMesh mesh;
  MeshStatistics statistics;
  ASSERT_FALSE(extractMesh(pcl_slim_test::fitted(cloud).surface, params, mesh, &statistics));
  // The windows, and a gap between points where the system's mathematics rounds otherwise.
  EXPECT_GE(statistics.closed_holes, 6u);
  EXPECT_LE(statistics.closed_holes, 7u);
  // A plane across a hole of radius 10 would be 28 - sqrt(28^2 - 10^2) = 1.8 below the ball.
  for (const Vector3& p : mesh.vertices) EXPECT_NEAR(length(p), 28, 0.2);
  EXPECT_NEAR(statistics.area / (4 * M_PI * 28 * 28), 1, 0.002);
}

/** The holes that stay of 25, in a flat or wavy plate of 80 x 80 spacings. */
std::uint64_t holesKept(double width, double wave) {
  Cloud cloud;
  std::mt19937_64 random(9);
  std::normal_distribution<double> gauss(0, 0.1);
  for (int i = 0; i < 6400; ++i) {
    const double x = uniform(random, 0, 80), y = uniform(random, 0, 80);
    const double dx = std::remainder(x - 8, 16), dy = std::remainder(y - 8, 16);
    if (std::hypot(dx, dy) < width / 2) continue;
    cloud.addNoisy({x, y, wave * std::sin(x / 8)}, gauss, random);
  }
  TriangleMesh mesh;
  MeshStatistics statistics;
  EXPECT_FALSE(extractMesh(pcl_slim_test::fitted(cloud).surface, {}, mesh, &statistics));
  EXPECT_EQ(statistics.sheet_ends, 1u);
  return statistics.border_loops - 1;
}

TEST(Holes, StayFromSixSpacingsOn) {
  for (const double wave : {0.0, 3.0}) {
    EXPECT_GE(holesKept(6, wave), 22u) << "by chance points leave narrower ones";
    EXPECT_EQ(holesKept(7, wave), 25u);
    EXPECT_EQ(holesKept(4.5, wave), 0u);
  }
}

}  // namespace

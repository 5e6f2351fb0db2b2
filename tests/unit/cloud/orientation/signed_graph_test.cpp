// SPDX-License-Identifier: BSD-3-Clause
// Agreement of patches, votes, and what faces outward.
#include "pcl_slim/cloud/detail/signed_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "unit/cloud/orientation/side_patches.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;
using namespace pcl_slim_test;

/** Expects the agreement of two patches, and its negative where either one turns. */
void expectAgreement(const SidePatch& p, const SidePatch& q, double expected, double tolerance) {
  SidePatch turned = q;
  turnPatch(turned);
  EXPECT_NEAR(agreementOf(p, q), expected, tolerance);
  EXPECT_NEAR(agreementOf(q, p), expected, tolerance);
  EXPECT_NEAR(agreementOf(p, turned), -expected, tolerance);
}

TEST(Agreement, OfArcsIsPositiveUpToTheOtherSide) {
  for (int degrees = 1; degrees < 180; degrees += 7) {
    const double t = degrees * M_PI / 180;
    const SidePatch p{{1, 0, 0}, {1, 0, 0}, 1};
    const SidePatch q{{std::cos(t), std::sin(t), 0}, {std::cos(t), std::sin(t), 0}, 1};
    expectAgreement(p, q, std::pow(std::cos(t / 2), 2), 1e-12);
    // Seen from inside it is the same arc.
    SidePatch inner_p = p, inner_q = q;
    turnPatch(inner_p);
    turnPatch(inner_q);
    expectAgreement(inner_p, inner_q, std::pow(std::cos(t / 2), 2), 1e-12);
  }
}

TEST(Agreement, OfCreasesIsPositive) {
  for (const double a : {0.1, 0.5, 1.0, 3.0}) {
    for (const double b : {0.1, 0.5, 1.0, 3.0}) {
      // Faces at a right angle, patches a and b from the edge: 2 s (1 - s), s = a b / (a^2 + b^2).
      const double s = a * b / (a * a + b * b), expected = 2 * s * (1 - s);
      const SidePatch top{{-a, 0, 0}, {0, 0, 1}, 1};
      expectAgreement(top, {{0, 0, -b}, {1, 0, 0}, 1}, expected, 1e-12);  // convex
      expectAgreement(top, {{0, 0, b}, {-1, 0, 0}, 1}, expected, 1e-12);  // concave
    }
  }
  for (int degrees = 100; degrees <= 180; degrees += 10) {  // wide creases agree fully
    const double bend = M_PI - degrees * M_PI / 180;
    const SidePatch top{{-1, 0, 0}, {0, 0, 1}, 1};
    const Vector3 down{std::cos(bend), 0, -std::sin(bend)}, n{std::sin(bend), 0, std::cos(bend)};
    EXPECT_GT(agreementOf(top, {down, n, 1}), 0.5) << degrees;
  }
}

TEST(Agreement, AcrossGapsAndThinPlatesDecidesNothing) {
  const std::vector<SidePatch> patches{{{0, 0, 0}, {0, 0, 1}, 1},
                                       {{0.1, 0, 1}, {0, 0, -1}, 1},
                                       {{0.1, 0, -1}, {0, 0, -1}, 1},
                                       {{1, 0, 0}, {0, 0, 1}, 1}};
  expectAgreement(patches[0], patches[1], 0, 0.02);
  expectAgreement(patches[0], patches[2], 0, 0.02);
  EXPECT_TRUE(edgeBetween(patches, 0, 1).apart);
  EXPECT_TRUE(edgeBetween(patches, 0, 2).apart);
  EXPECT_FALSE(edgeBetween(patches, 0, 3).apart);
  EXPECT_EQ(edgeBetween(patches, 0, 3).agreement, 1);
}

TEST(Agreement, OfPatchesAtOnePlaceIsTheCosine) {
  const SidePatch p{{1, 2, 3}, {0, 0, 1}, 1}, q{{1, 2, 3}, {0, 0.6, 0.8}, 1};
  expectAgreement(p, q, 0.8, 1e-12);
  EXPECT_FALSE(edgeBetween({p, q}, 0, 1).apart);
}

/** A chain of nodes that agree. */
std::vector<SignedEdge> chainOf(std::uint32_t nodes) {
  std::vector<SignedEdge> edges;
  for (std::uint32_t i = 0; i + 1 < nodes; ++i) edges.push_back({i, i + 1, 1});
  return edges;
}

TEST(SignsByVotes, OneStrongVoteTurnsAWholeChain) {
  const std::size_t nodes = 50;
  for (const std::size_t at : {std::size_t{0}, std::size_t{31}}) {
    std::vector<double> votes(nodes, 0.05);
    votes[at] = -5;
    EXPECT_EQ(signsByVotes(chainOf(nodes), votes), std::vector<signed char>(nodes, -1));
    votes[at] = 5;
    EXPECT_EQ(signsByVotes(chainOf(nodes), votes), std::vector<signed char>(nodes, 1));
  }
}

TEST(SignsByVotes, ContradictingVotesSplitAtTheWeakestEdge) {
  std::vector<SignedEdge> edges = chainOf(20);
  edges[12].agreement = 0.2;
  std::vector<double> votes(20, 0.0);
  votes.front() = 100;
  votes.back() = -100;
  std::vector<signed char> expected(20, 1);
  std::fill(expected.begin() + 13, expected.end(), static_cast<signed char>(-1));
  EXPECT_EQ(signsByVotes(edges, votes), expected);
}

TEST(SignsByVotes, FollowNegativeEdgesAndLeavePartsWithoutVotesToThemselves) {
  // Nodes 0 to 2 have a vote; 3 and 4, which are opposite, have none; 5 has no edge.
  const std::vector<SignedEdge> edges{{0, 1, -1}, {1, 2, 1}, {3, 4, -1}};
  const auto signs = signsByVotes(edges, {0, 0, 3, 0, 0, -1});
  ASSERT_EQ(signs.size(), 6u);
  EXPECT_EQ(signs[2], 1);
  EXPECT_EQ(signs[1], 1);
  EXPECT_EQ(signs[0], -1);
  EXPECT_EQ(signs[3] * signs[4], -1);
  EXPECT_EQ(signs[5], -1);
  EXPECT_TRUE(signsByVotes({}, {}).empty());
}

/** Expects that signsOutward() turns patches that were turned at random back, and no others. */
void expectOutward(const std::vector<SidePatch>& truth, const char* what,
                   std::size_t neighbors = 8) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::vector<SidePatch> patches = truth;
    const std::vector<bool> turned = turnSome(patches, 0.5, seed);
    const auto signs = signsOutward(patches, nearestEdges(patches, neighbors));
    ASSERT_EQ(signs.size(), patches.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < signs.size(); ++i) wrong += (signs[i] < 0) != turned[i];
    EXPECT_EQ(wrong, 0u) << what << ", seed " << seed << ": of " << signs.size();
  }
}

TEST(TurnOutward, ClosedBodies) {
  std::vector<SidePatch> sphere, cube, plate;
  addSpherePatches(400, -1, sphere);
  expectOutward(sphere, "sphere");
  addBoxPatches(8, 8, 8, cube);
  expectOutward(cube, "cube");
  addBoxPatches(14, 14, 2, plate);
  expectOutward(plate, "plate");
}

TEST(TurnOutward, ACubeOfSixFaces) {
  std::vector<SidePatch> faces;
  addBoxPatches(1, 1, 1, faces);
  expectOutward(faces, "faces", 4);  // all but the opposite one
}

TEST(TurnOutward, HalfASphere) {
  std::vector<SidePatch> half;
  addSpherePatches(300, 0, half);
  expectOutward(half, "half a sphere");
}

TEST(TurnOutward, TwoBodiesEach) {
  std::vector<SidePatch> two, other;
  addSpherePatches(300, -1, two);
  addSpherePatches(300, -1, other);
  for (SidePatch& patch : other) patch.center[0] += 3;
  two.insert(two.end(), other.begin(), other.end());
  expectOutward(two, "two spheres");
}

/** A sheet folded once at x = 0, its halves two apart: too flat to have an inside. */
std::vector<SidePatch> foldedSheet(int columns, int rows) {
  std::vector<SidePatch> patches;
  for (const double way : {1.0, -1.0}) {
    addGridPatches({0.5 * columns, 0, way}, {1, 0, 0}, {0, way, 0}, columns, rows, patches);
  }
  for (int y = 0; y < rows; ++y) {
    for (const double turn : {-0.25, 0.0, 0.25}) {
      const Vector3 n{-std::cos(M_PI * turn), 0, std::sin(M_PI * turn)};
      patches.push_back({{n[0], y + 0.5 - 0.5 * rows, n[2]}, n, 1});
    }
  }
  return patches;
}

TEST(TurnOutward, HalvesOfAFoldedSheetDoNotFaceEachOther) {
  expectOutward(foldedSheet(100, 5), "folded sheet", 16);  // edges across, too
}

/** The ground z = height(x, y) of a square of side 2, seen from above. */
template <typename Height>
std::vector<SidePatch> groundPatches(const Height& height) {
  constexpr int kCells = 20;
  constexpr double kStep = 1e-5;
  std::vector<SidePatch> patches;
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const double x = 2 * (i + 0.5) / kCells - 1, y = 2 * (j + 0.5) / kCells - 1;
      const double hx = (height(x + kStep, y) - height(x - kStep, y)) / (2 * kStep);
      const double hy = (height(x, y + kStep) - height(x, y - kStep)) / (2 * kStep);
      patches.push_back({{x, y, height(x, y)}, normalized({-hx, -hy, 1}), 1});
    }
  }
  return patches;
}

TEST(TurnOutward, GroundIsSeenFromAbove) {
  expectOutward(groundPatches([](double, double) { return 0.0; }), "plain");
  expectOutward(groundPatches([](double x, double y) { return 0.2 * (x * x + 0.3 * y); }),
                "valley");
  expectOutward(groundPatches([](double x, double y) { return -0.2 * (x * x + 0.3 * y); }), "hill");
  expectOutward(groundPatches([](double x, double y) { return 0.2 * (x * x - y * y); }), "pass");
}

TEST(TurnOutward, NoiseNeverTurnsATiltedSheet) {
  for (const double azimuth : {0.0, 0.5, 1.0, 1.5}) {
    for (const double way : {1.0, -1.0}) {
      const double c = std::cos(M_PI * azimuth), s = std::sin(M_PI * azimuth),
                   half = std::sqrt(0.5);
      const Vector3 u{-s, c, 0}, v = scaled({-c, -s, way}, half);  // u x v is 45 degrees off z
      std::size_t up = 0, all = 0;
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        std::vector<SidePatch> sheet;
        addGridPatches({5, -3, 2}, u, v, 12, 12, sheet);
        std::mt19937_64 random(seed);
        std::normal_distribution<double> gauss(0, 0.1);
        for (SidePatch& patch : sheet) {
          for (double& x : patch.center) x += gauss(random);
          for (double& x : patch.normal) x += gauss(random);
          patch.normal = normalized(patch.normal);
        }
        turnSome(sheet, 0.5, seed + 100);
        const auto signs = signsOutward(sheet, nearestEdges(sheet));
        for (std::size_t i = 0; i < sheet.size(); ++i) up += signs[i] * sheet[i].normal[2] > 0;
        all += sheet.size();
      }
      EXPECT_EQ(up, all) << azimuth << " " << way;
    }
  }
}

TEST(TurnOutward, NoiseNeverTurnsAWall) {
  for (const Vector3& axis : {Vector3{1, 0, 0}, Vector3{0, 1, 0}}) {
    std::size_t positive = 0, all = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      std::vector<SidePatch> wall;
      addGridPatches({1, 1, 1}, {axis[1], axis[0], 0}, {0, 0, 1}, 12, 12, wall);
      std::mt19937_64 random(seed);
      std::normal_distribution<double> gauss(0, 0.05);
      for (SidePatch& patch : wall) {
        for (double& x : patch.normal) x += gauss(random);
        patch.normal = normalized(patch.normal);
      }
      turnSome(wall, 0.5, seed + 100);
      const auto signs = signsOutward(wall, nearestEdges(wall));
      for (std::size_t i = 0; i < wall.size(); ++i)
        positive += signs[i] * dot(wall[i].normal, axis) > 0;
      all += wall.size();
    }
    EXPECT_TRUE(positive == 0 || positive == all) << positive << " of " << all;
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Given normals, some of which are turned.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/cloud/detail/signed_graph.h"
#include "unit/cloud/orientation/side_patches.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;
using namespace pcl_slim_test;

TEST(SignedRegions, AreNumberedByTheirFirstNodes) {
  SignedRegions regions(7);
  regions.join(5, 2);
  regions.join(6, 0);
  regions.join(2, 3);
  regions.join(3, 5);  // joined already
  EXPECT_EQ(regions.number(), 4u);
  const std::vector<std::uint32_t> expected{0, 1, 2, 2, 3, 2, 0};
  for (std::uint32_t i = 0; i < 7; ++i) EXPECT_EQ(regions.of(i), expected[i]) << i;
}

TEST(SignedRegions, OfNoNodesAreNone) {
  SignedRegions regions(0);
  EXPECT_EQ(regions.number(), 0u);
}

/** Two opposed patches, whichever comes first. */
Opposition oppositionOfPair(const SidePatch& p, const SidePatch& q) {
  Opposition first, second;
  first.add(p, q);
  second.add(q, p);
  EXPECT_EQ(first.level, second.level);
  EXPECT_EQ(first.ahead, second.ahead);
  EXPECT_EQ(first.behind, second.behind);
  return first;
}

TEST(Opposition, OfNeighboursOfOneSheetIsLevel) {
  for (int degrees = 0; degrees <= 20; degrees += 5) {  // bends of the sheet between the two
    for (const double way : {1.0, -1.0}) {
      const double t = degrees * M_PI / 180;
      const SidePatch p{{0, 0, 0}, {0, 0, 1}, 1};
      SidePatch q{
          {std::cos(t / 2), 0, -way * std::sin(t / 2)}, {way * std::sin(t), 0, std::cos(t)}, 1};
      EXPECT_EQ(oppositionOfPair(p, q).all(), 0) << degrees;
      turnPatch(q);
      // Only one of the two is behind the other.
      EXPECT_EQ(oppositionOfPair(p, q).level, 1) << degrees << " " << way;
      EXPECT_EQ(oppositionOfPair(p, q).contradictions(), 1) << degrees << " " << way;
    }
  }
}

TEST(Opposition, OfSidesOfAThinPlateAndAcrossAGapIsNoContradiction) {
  for (const double distance : {0.05, 0.2, 1.0, 1.5}) {
    for (const double offset : {0.0, 0.3, 1.0, 2.0}) {
      SidePatch top{{offset, 0, distance}, {0, 0, 1}, 1}, bottom{{0, 0, 0}, {0, 0, -1}, 1};
      const double opposed = agreementOf(top, bottom) < -0.5 ? 1 : 0;
      EXPECT_EQ(oppositionOfPair(top, bottom).behind, opposed) << distance << " " << offset;
      EXPECT_EQ(oppositionOfPair(top, bottom).contradictions(), 0) << distance << " " << offset;
      turnPatch(top);
      turnPatch(bottom);
      EXPECT_EQ(oppositionOfPair(top, bottom).ahead, opposed) << distance << " " << offset;
      EXPECT_EQ(oppositionOfPair(top, bottom).contradictions(), 0) << distance << " " << offset;
    }
  }
}

TEST(Opposition, OfANoisySheetOfBothSignsIsAheadAsOftenAsBehind) {
  Opposition sheet;
  sheet.ahead = sheet.behind = 10;
  EXPECT_EQ(sheet.contradictions(), 10);
  sheet.level = 5;
  EXPECT_GT(sheet.contradictions(), 10);
  EXPECT_EQ(sheet.all(), 25);
}

TEST(Opposition, OfFacesAtARightAngleIsNone) {
  for (const double a : {0.01, 0.3, 1.0}) {
    for (const double b : {0.01, 0.3, 1.0}) {
      for (const double way : {1.0, -1.0}) {
        const SidePatch p{{-a, 0, 0}, {0, 0, 1}, 1};
        EXPECT_EQ(oppositionOfPair(p, {{0, 0, b}, {way, 0, 0}, 1}).all(), 0);
        EXPECT_EQ(oppositionOfPair(p, {{0, 0, -b}, {way, 0, 0}, 1}).all(), 0);
      }
    }
  }
}

/** Patches that should not turn, some of which have turned; the signs that are found. */
std::size_t wrongSigns(std::vector<SidePatch> patches, const std::vector<bool>& turned,
                       const std::vector<double>& votes = {}) {
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (turned[i]) turnPatch(patches[i]);
  }
  const auto signs = signsOfGiven(patches, nearestEdges(patches), votes);
  EXPECT_EQ(signs.size(), patches.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < signs.size(); ++i) wrong += (signs[i] < 0) != turned[i];
  return wrong;
}

std::vector<bool> randomTurns(std::size_t count, double share, std::uint64_t seed) {
  std::vector<SidePatch> unused(count);
  return turnSome(unused, share, seed);
}

TEST(SignsOfGiven, ASphereWithRandomFlipsFacesOutward) {
  std::vector<SidePatch> sphere;
  addSpherePatches(600, -1, sphere);
  for (const double share : {0.0, 0.01, 0.2, 0.5}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      EXPECT_EQ(wrongSigns(sphere, randomTurns(sphere.size(), share, seed)), 0u)
          << share << " flipped, seed " << seed;
    }
  }
}

TEST(SignsOfGiven, AFlippedCapTurnsBack) {
  std::vector<SidePatch> sphere;
  addSpherePatches(600, -1, sphere);
  for (const double height : {0.95, 0.7, 0.55}) {
    std::vector<bool> turned;
    for (const SidePatch& patch : sphere) turned.push_back(patch.center[2] > height);
    EXPECT_EQ(wrongSigns(sphere, turned), 0u) << height;
  }
}

TEST(SignsOfGiven, InwardNormalsThatMostlyAgreeStayInward) {
  std::vector<SidePatch> sphere;
  addSpherePatches(600, -1, sphere);
  for (SidePatch& patch : sphere) turnPatch(patch);
  EXPECT_EQ(wrongSigns(sphere, randomTurns(sphere.size(), 0.1, 5)), 0u);
}

TEST(SignsOfGiven, VotesDecideForTheWhole) {
  std::vector<SidePatch> sphere;
  addSpherePatches(600, -1, sphere);
  for (const double out : {1.0, -1.0}) {
    std::vector<SidePatch> truth = sphere;
    if (out < 0)
      for (SidePatch& patch : truth) turnPatch(patch);
    const std::vector<bool> turned = randomTurns(truth.size(), 0.3, 4);
    std::vector<double> votes;
    for (const bool t : turned) votes.push_back(t ? -kBeamWeight : kBeamWeight);
    EXPECT_EQ(wrongSigns(truth, turned, votes), 0u) << out;
  }
}

TEST(SignsOfGiven, ThinPlatesBackToBackStayAsTheyAre) {
  std::vector<SidePatch> plate;
  const Vector3 ux{1, 0, 0}, uy{0, 1, 0};
  addGridPatches({0, 0, 0.75}, ux, uy, 20, 20, plate);
  addGridPatches({0.3, 0.4, -0.75}, uy, ux, 20, 20, plate);
  EXPECT_EQ(wrongSigns(plate, std::vector<bool>(plate.size(), false)), 0u);
  // Few flips turn back.
  EXPECT_EQ(wrongSigns(plate, randomTurns(plate.size(), 0.05, 3)), 0u);
}

TEST(SignsOfGiven, ABoxWithFlipsKeepsItsEdges) {
  std::vector<SidePatch> box;
  addBoxPatches(8, 6, 5, box);
  EXPECT_EQ(wrongSigns(box, std::vector<bool>(box.size(), false)), 0u);
  EXPECT_EQ(wrongSigns(box, randomTurns(box.size(), 0.03, 9)), 0u);
}

/** A wedge of two faces at an angle and its back, random patches, spacing 1. */
std::vector<SidePatch> wedgePatches(double degrees) {
  std::vector<SidePatch> patches;
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> unit(0, 30);
  const double c = std::cos(degrees * M_PI / 360), s = std::sin(degrees * M_PI / 360);
  for (int i = 0; i < 1800; ++i) {
    const double way = i % 2 ? 1 : -1, x = unit(random), y = unit(random);
    patches.push_back({{x * c, y, way * x * s}, {-s, 0, way * c}, 1});
  }
  for (int i = 0; i < static_cast<int>(2 * 900 * s); ++i)
    patches.push_back({{30 * c, unit(random), s * (2 * unit(random) - 30)}, {1, 0, 0}, 1});
  return patches;
}

TEST(SignsOfGiven, ExactNormalsOfAWedgeStayAsTheyAre) {
  for (const double degrees : {5.0, 10.0, 20.0, 45.0, 70.0, 110.0}) {
    const std::vector<SidePatch> wedge = wedgePatches(degrees);
    // Of patches right at a sharp edge a few are beside the other face alone.
    EXPECT_LE(wrongSigns(wedge, std::vector<bool>(wedge.size(), false)), wedge.size() / 500)
        << degrees;
    // Flips right at the edge resemble the other face.
    EXPECT_LE(wrongSigns(wedge, randomTurns(wedge.size(), 0.02, 4)), wedge.size() / 100) << degrees;
  }
}

/** A vessel's rim of evenly spread patches: an outer and an inner wall, some spacings apart. */
std::vector<SidePatch> rimPatches(double thickness, double depth) {
  std::vector<SidePatch> patches;
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr double kOuter = 10;
  const double inner = kOuter - thickness;
  const auto add = [&](double area, const auto& place) {
    for (int i = 0; i < static_cast<int>(area); ++i)
      patches.push_back(place(2 * M_PI * unit(random)));
  };
  add(2 * M_PI * kOuter * 2 * depth, [&](double t) {
    const Vector3 n{std::cos(t), std::sin(t), 0};
    return SidePatch{along({0, 0, -2 * depth * unit(random)}, kOuter, n), n, 1};
  });
  add(2 * M_PI * inner * depth, [&](double t) {
    const Vector3 n{-std::cos(t), -std::sin(t), 0};
    return SidePatch{along({0, 0, -depth * unit(random)}, -inner, n), n, 1};
  });
  add(M_PI * (kOuter * kOuter - inner * inner), [&](double t) {
    const double r = inner + thickness * unit(random);
    return SidePatch{{r * std::cos(t), r * std::sin(t), 0}, {0, 0, 1}, 1};
  });
  return patches;
}

TEST(SignsOfGiven, ExactNormalsOfAThinWalledRimStayAsTheyAre) {
  for (const double thickness : {0.7, 1.0, 1.6, 2.5}) {
    const std::vector<SidePatch> rim = rimPatches(thickness, 8);
    EXPECT_LE(wrongSigns(rim, std::vector<bool>(rim.size(), false)), rim.size() / 500) << thickness;
    for (const double share : {0.01, 0.05}) {
      EXPECT_LE(wrongSigns(rim, randomTurns(rim.size(), share, 4)), rim.size() / 100)
          << thickness << ", " << share << " flipped";
    }
  }
}

}  // namespace

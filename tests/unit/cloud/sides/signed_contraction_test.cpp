// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/signed_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

namespace {

using namespace pcl_slim::detail;

/** Edges of a grid whose nodes have hidden signs, a share of them wrong and weak. */
std::vector<SignedEdge> gridEdges(std::uint32_t side, const std::vector<int>& hidden, double wrong,
                                  std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SignedEdge> edges;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t i = y * side + x;
      for (const std::uint32_t j : {x + 1 < side ? i + 1 : i, y + 1 < side ? i + side : i}) {
        if (j == i) continue;
        const double agreement = hidden[i] * hidden[j] * (0.5 + 0.5 * unit(rng));
        const bool flipped = unit(rng) < wrong;
        edges.push_back({i, j, flipped ? -0.4 * agreement : agreement});
      }
    }
  }
  return edges;
}

TEST(SignedContraction, FindsHiddenSignsAmongWrongEdges) {
  const std::uint32_t side = 40;
  std::mt19937_64 rng(3);
  std::vector<int> hidden(side * side);
  for (int& sign : hidden) sign = (rng() & 1) != 0 ? 1 : -1;
  const SignedParts parts = contractSigned(hidden.size(), gridEdges(side, hidden, 0.1, 5));
  std::size_t right = 0;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    EXPECT_EQ(parts.part[i], 0u);
    right += parts.signs[i] == hidden[i];
  }
  // A node with most of its four edges wrong, one of some 300, cannot be detected.
  EXPECT_GT(std::max(right, hidden.size() - right), hidden.size() * 97 / 100);
}

TEST(SignedContraction, KeepsUnconnectedPartsApart) {
  const SignedParts parts = contractSigned(5, {{0, 1, 1.0}, {2, 3, -0.5}});
  EXPECT_EQ(parts.part, (std::vector<std::uint32_t>{0, 0, 2, 2, 4}));
  EXPECT_EQ(parts.signs[0] * parts.signs[1], 1);
  EXPECT_EQ(parts.signs[2] * parts.signs[3], -1);
}

TEST(SignedContraction, SumsDecideWhereSingleEdgesDisagree) {
  // 0-1 are joined first; three weak edges of 2 then outweigh its strongest one.
  const SignedParts parts =
      contractSigned(3, {{0, 1, 1.0}, {0, 2, 0.5}, {1, 2, -0.3}, {2, 1, -0.3}});
  EXPECT_EQ(parts.signs[0] * parts.signs[1], 1);
  EXPECT_EQ(parts.signs[0] * parts.signs[2], -1);
}

TEST(SignedContraction, OrderAndDirectionOfEdgesDoNotMatter) {
  const std::uint32_t side = 60;
  std::vector<int> hidden(side * side, 1);
  const auto edges = gridEdges(side, hidden, 0.2, 9);
  auto turned = edges;
  std::reverse(turned.begin(), turned.end());
  for (SignedEdge& e : turned) e = {e.b, e.a, e.agreement};
  EXPECT_EQ(contractSigned(hidden.size(), edges).signs,
            contractSigned(hidden.size(), turned).signs);
  EXPECT_TRUE(contractSigned(0, {}).signs.empty());
}

TEST(SignedContraction, ANodeMayHaveManyEdges) {
  // A hub in the middle of the numbers, and few edges for the many nodes.
  std::vector<SignedEdge> edges;
  for (std::uint32_t i = 0; i < 400; ++i) {
    if (i != 150) edges.push_back({150, i, i % 3 == 0 ? -1.0 : 1.0});
  }
  const SignedParts parts = contractSigned(100000, edges);
  for (std::uint32_t i = 0; i < 400; ++i) {
    const int expected = i % 3 == 0 && i != 150 ? -1 : 1;
    EXPECT_EQ(parts.signs[i] * parts.signs[150], expected) << i;
  }
  EXPECT_EQ(parts.part[99999], 99999u);
}

}  // namespace

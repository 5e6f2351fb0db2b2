// SPDX-License-Identifier: BSD-3-Clause
#include "contour/contour.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

CellTree treeOfSphere(double tolerance, int threads = 1) {
  const auto fit =
      pcl_slim_test::fitted(pcl_slim_test::sceneCloud(measure::Shape::kSphere, 3000, 0));
  CellTree tree;
  EXPECT_FALSE(tree.build(shapesOf(fit.surface, tolerance, 1, 1), threads));
  return tree;
}

TEST(CellTree, CellsFillTheRootInMortonOrder) {
  const CellTree tree = treeOfSphere(1e-4);
  double volume = 0;
  for (const CellPlace& cell : tree.cells()) volume += std::pow(0.125, cell.depth);
  EXPECT_NEAR(volume, 1, 1e-12);
  EXPECT_GT(tree.numNear(), 1000u);
  EXPECT_LT(tree.numNear(), tree.cells().size());
  EXPECT_EQ(tree.cells().size() % 7, 1u) << "each division adds seven cells";
}

TEST(CellTree, ThreadsDoNotMatter) {
  const CellTree one = treeOfSphere(1e-4, 1), four = treeOfSphere(1e-4, 4);
  ASSERT_EQ(one.cells().size(), four.cells().size());
  for (std::size_t i = 0; i < one.cells().size(); ++i) {
    ASSERT_EQ(one.cells()[i].depth, four.cells()[i].depth);
    for (int a = 0; a < 3; ++a) ASSERT_EQ(one.cells()[i].low[a], four.cells()[i].low[a]);
  }
}

TEST(CellTree, SplitDividesTheCellsNamed) {
  CellTree tree = treeOfSphere(1e-3);
  const std::size_t before = tree.cells().size();
  const CellPlace third = tree.cells()[3];
  tree.split({3, 7});
  EXPECT_EQ(tree.cells().size(), before + 14);
  EXPECT_EQ(tree.cells()[3].depth, third.depth + 1);
  EXPECT_EQ(tree.cells()[3].low[0], third.low[0]);
}

using EdgeKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int, int>;

EdgeKey keyOf(const CellEdge& edge) {
  return {edge.low[0], edge.low[1], edge.low[2], edge.axis, edge.depth};
}

TEST(CellEdges, FreshOnesAreThoseOfDividedCells) {
  CellTree tree = treeOfSphere(1e-3);
  std::vector<std::uint32_t> divided;
  for (const CellNode& node : tree.nodes()) {
    if (node.first_child == 0 && node.near && node.cell % 50 == 0) divided.push_back(node.cell);
  }
  ASSERT_GT(divided.size(), 5u);
  const auto before = cellEdges(tree);
  const auto numbers = tree.split(divided);
  std::set<EdgeKey> expected;
  for (const CellEdge& edge : before) {
    bool whole = true;
    for (const std::uint32_t cell : edge.cell) whole = whole && numbers[cell] != CellTree::kDivided;
    if (whole) expected.insert(keyOf(edge));
  }
  const auto fresh = cellEdges(tree, true);
  for (const CellEdge& edge : fresh) EXPECT_TRUE(expected.insert(keyOf(edge)).second);
  std::set<EdgeKey> all;
  for (const CellEdge& edge : cellEdges(tree)) all.insert(keyOf(edge));
  EXPECT_EQ(expected, all);
  EXPECT_LT(fresh.size(), all.size() / 2);
}

TEST(CellEdges, AreMinimalUniqueAndSurroundedByTheirCells) {
  CellTree tree = treeOfSphere(1e-3);
  tree.split({tree.nodes()[tree.nodes().size() / 2].cell});
  const auto edges = cellEdges(tree);
  EXPECT_GT(edges.size(), 1000u);
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, int>> seen;
  for (const CellEdge& edge : edges) {
    EXPECT_TRUE(seen.emplace(edge.low[0], edge.low[1], edge.low[2], edge.axis).second);
    const std::uint32_t length = CellTree::width(edge.depth);
    const unsigned int b = (edge.axis + 1u) % 3, c = (edge.axis + 2u) % 3;
    // Counter-clockwise: low low, high low, high high, low high.
    constexpr int kSides[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int k = 0; k < 4; ++k) {
      const CellPlace& cell = tree.cells()[edge.cell[k]];
      const std::uint32_t width = CellTree::width(cell.depth);
      EXPECT_GE(width, length) << "no finer cell divides it";
      EXPECT_LE(cell.low[edge.axis], edge.low[edge.axis]);
      EXPECT_GE(cell.low[edge.axis] + width, edge.low[edge.axis] + length);
      // The place next to the edge on this side is in the cell.
      const std::uint32_t at_b = edge.low[b] - (kSides[k][0] == 0 ? 1 : 0);
      const std::uint32_t at_c = edge.low[c] - (kSides[k][1] == 0 ? 1 : 0);
      EXPECT_TRUE(cell.low[b] <= at_b && at_b < cell.low[b] + width);
      EXPECT_TRUE(cell.low[c] <= at_c && at_c < cell.low[c] + width);
    }
  }
}

}  // namespace

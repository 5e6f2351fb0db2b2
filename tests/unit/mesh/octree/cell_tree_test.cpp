// SPDX-License-Identifier: BSD-3-Clause
#include "contour/contour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

CellTree treeOfSphere(double tolerance, int threads = 1) {
  const auto fit =
      pcl_slim_test::fitted(pcl_slim_test::sceneCloud(measure::Shape::kSphere, 3000, 0));
  CellTree tree;
  EXPECT_FALSE(tree.build(shapesOf(fit.surface, tolerance, 1, false, 1), threads));
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

TEST(CellTree, BordersDivideCellsAndNothingElseDoes) {
  const auto sphere =
      pcl_slim_test::fitted(pcl_slim_test::sceneCloud(measure::Shape::kSphere, 3000, 0));
  CellTree without, with;
  ASSERT_FALSE(without.build(shapesOf(sphere.surface, 1e-3, 1, false, 1), 1));
  ASSERT_FALSE(with.build(shapesOf(sphere.surface, 1e-3, 1, true, 1), 1));
  EXPECT_EQ(with.cells().size(), without.cells().size()) << "a closed body has no border";

  pcl_slim_test::Cloud square;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 1);
  for (int i = 0; i < 10000; ++i) {
    const double x = place(random), y = place(random);
    square.add(x, y, 0);
  }
  const auto plate = pcl_slim_test::fitted(square);
  const SLIMSurface& surface = plate.surface;
  const auto shapes = shapesOf(surface, 1e-3, 1, true, 1);
  CellTree tree;
  ASSERT_FALSE(without.build(shapesOf(surface, 1e-3, 1, false, 1), 1));
  ASSERT_FALSE(tree.build(shapes, 1));
  EXPECT_GT(tree.numNear(), 5 * without.numNear());
  // The square in local units.
  const double low = (0 - surface.info.origin[0]) / surface.info.scale;
  const double side = 1 / surface.info.scale, spacing = side / 100;
  std::size_t wide = 0;
  for (const CellNode& node : tree.nodes()) {
    if (!node.near || node.first_child != 0) continue;
    const CellPlace& cell = tree.cells()[node.cell];
    const Vector3 from = tree.corner(cell.low);
    const double size = tree.size(cell.depth);
    const bool on_rim = (from[0] < low) != (from[0] + size < low) && from[1] > low + size &&
                        from[1] + 2 * size < low + side;
    if (on_rim) {
      EXPECT_LE(size, 4 * spacing);
    }
    wide += size > 8 * spacing ? 1 : 0;
  }
  EXPECT_GT(wide, 4u) << "the middle is as coarse as it may be";
}

TEST(BorderTable, FindsWhatAMapHas) {
  std::mt19937 random(9);
  for (const int side : {5, 9, 64, 128}) {
    std::vector<std::uint8_t> bits(TrimMap::numBytes(side), 0xff);
    TrimMap map;
    map.side = side;
    map.bits = bits.data();
    const double whole[2] = {1, 1}, middle[2] = {0, 0};
    EXPECT_FALSE(BorderTable(map).any(middle, whole)) << "all inside";
    for (int trial = 0; trial < 20; ++trial) {
      std::fill(bits.begin(), bits.end(), 0xff);
      // One node outside, not far from the centre.
      const int column = side / 4 + static_cast<int>(random() % static_cast<unsigned>(side / 2));
      const int row = side / 4 + static_cast<int>(random() % static_cast<unsigned>(side / 2));
      const int k = row * side + column;
      bits[static_cast<std::size_t>(k >> 3)] &= static_cast<std::uint8_t>(~(1u << (k & 7)));
      const BorderTable table(map);
      const double node = 2.0 / (side - 1);
      const double at[2] = {column * node - 1, row * node - 1};
      const double reach[2] = {0.6 * node, 0.6 * node};
      EXPECT_TRUE(table.any(middle, whole));
      EXPECT_TRUE(table.any(at, reach));
      const double left[2] = {at[0] - 3 * node, at[1]}, below[2] = {at[0], at[1] - 3 * node};
      EXPECT_FALSE(table.any(left, reach));
      EXPECT_FALSE(table.any(below, reach));
      const double beyond[2] = {2.5, at[1]};
      EXPECT_FALSE(table.any(beyond, reach));
    }
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

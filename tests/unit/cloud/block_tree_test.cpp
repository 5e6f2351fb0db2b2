// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/block_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

constexpr double kRounding = 1e-5;

/** Boxes of mixed size, some of them points or flat. */
BlockTree::Level randomBoxes(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> place(-0.5f, 0.5f), extent(0.0f, 0.05f);
  BlockTree::Level boxes;
  boxes.allocate(count);
  AlignedVector<float>* low[] = {&boxes.min_x, &boxes.min_y, &boxes.min_z};
  AlignedVector<float>* high[] = {&boxes.max_x, &boxes.max_y, &boxes.max_z};
  for (std::size_t b = 0; b < count; ++b) {
    for (int a = 0; a < 3; ++a) {
      (*low[a])[b] = place(random);
      (*high[a])[b] = (*low[a])[b] + (b % 3 == 0 ? 0.0f : extent(random));
    }
  }
  return boxes;
}

double distanceToBox(const BlockTree::Level& boxes, std::size_t b, const float center[3]) {
  const double low[] = {boxes.min_x[b], boxes.min_y[b], boxes.min_z[b]};
  const double high[] = {boxes.max_x[b], boxes.max_y[b], boxes.max_z[b]};
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double gap = std::max({low[a] - center[a], center[a] - high[a], 0.0});
    sum += gap * gap;
  }
  return std::sqrt(sum);
}

/** The blocks found are ascending, contain every block clearly inside and none clearly outside. */
void expectBall(const BlockTree::Level& boxes, const float center[3], float radius,
                const std::vector<std::uint32_t>& found) {
  ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
  ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  for (std::size_t b = 0; b < boxes.count; ++b) {
    const double distance = distanceToBox(boxes, b, center);
    if (std::abs(distance - radius) < kRounding) continue;
    const bool hit = std::binary_search(found.begin(), found.end(), static_cast<std::uint32_t>(b));
    ASSERT_EQ(hit, distance < radius) << "block " << b << " at " << distance << " of " << radius;
  }
}

TEST(BlockTree, FindsTheBlocksOfABall) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-0.6f, 0.6f), size(0.001f, 0.4f);
  for (const std::size_t count : {1, 15, 16, 17, 255, 256, 257, 4097}) {
    const auto boxes = randomBoxes(count, random);
    const BlockTree tree(boxes);
    EXPECT_EQ(tree.numBlocks(), count);
    for (int query = 0; query < 40; ++query) {
      const float center[] = {place(random), place(random), place(random)};
      const float radius = query % 8 == 0 ? 2.0f : size(random);
      std::vector<std::uint32_t> found;
      tree.blocksInBall(center, radius, found);
      expectBall(boxes, center, radius, found);
    }
  }
}

TEST(BlockTree, FindsTheBlocksOfABox) {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> place(-0.6f, 0.6f);
  for (const std::size_t count : {3, 16, 300, 4097}) {
    const auto boxes = randomBoxes(count, random);
    const BlockTree tree(boxes);
    for (int query = 0; query < 40; ++query) {
      float low[3], high[3];
      for (int a = 0; a < 3; ++a) {
        low[a] = place(random);
        high[a] = low[a] + 0.3f * std::abs(place(random));
      }
      std::vector<std::uint32_t> found, expected;
      tree.blocksInBox(low, high, found);
      for (std::uint32_t b = 0; b < count; ++b) {
        if (boxes.max_x[b] >= low[0] && boxes.min_x[b] <= high[0] && boxes.max_y[b] >= low[1] &&
            boxes.min_y[b] <= high[1] && boxes.max_z[b] >= low[2] && boxes.min_z[b] <= high[2]) {
          expected.push_back(b);
        }
      }
      ASSERT_EQ(found, expected);
    }
  }
}

TEST(BlockTree, AppendsAndHoldsNothingWhenEmpty) {
  const float center[] = {0.0f, 0.0f, 0.0f};
  std::vector<std::uint32_t> found = {99};
  BlockTree().blocksInBall(center, 10.0f, found);
  BlockTree().blocksInBox(center, center, found);
  EXPECT_EQ(found, std::vector<std::uint32_t>{99});
  EXPECT_EQ(BlockTree().numBlocks(), 0u);
  std::mt19937 random(13);
  BlockTree(randomBoxes(20, random)).blocksInBall(center, 10.0f, found);
  ASSERT_EQ(found.size(), 21u);
  EXPECT_EQ(found.front(), 99u);
}

TEST(BlockNeighborhood, AnswersAsTheTreeWithinItsRegion) {
  std::mt19937 random(14);
  std::uniform_real_distribution<float> place(-0.4f, 0.4f), size(0.001f, 0.1f);
  const auto boxes = randomBoxes(3000, random);
  const BlockTree tree(boxes);
  BlockNeighborhood region;
  for (int round = 0; round < 20; ++round) {
    const float middle[] = {place(random), place(random), place(random)};
    const float low[] = {middle[0] - 0.15f, middle[1] - 0.15f, middle[2] - 0.15f};
    const float high[] = {middle[0] + 0.15f, middle[1] + 0.15f, middle[2] + 0.15f};
    region.collect(tree, low, high);
    for (int query = 0; query < 20; ++query) {
      const float radius = size(random);
      const float room = 0.15f - radius;
      float center[3];
      for (int a = 0; a < 3; ++a) center[a] = middle[a] + 2.0f * room * place(random);
      std::vector<std::uint32_t> of_tree;
      BlockList of_region = {7, 7, 7};
      tree.blocksInBall(center, radius, of_tree);
      region.blocksInBall(center, radius, of_region);
      ASSERT_EQ(std::vector<std::uint32_t>(of_region.begin(), of_region.end()), of_tree);
    }
  }
}

TEST(BlockTree, AStoresBlocksHoldTheirPoints) {
  const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kBumpy, 3001, 0.0);
  const PointStore store = pcl_slim_test::storeOf(cloud);
  std::mt19937 random(15);
  std::uniform_int_distribution<std::size_t> pick(0, store.size() - 1);
  for (int query = 0; query < 50; ++query) {
    const auto p = store.position(pick(random));
    const float center[] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                            static_cast<float>(p[2])};
    const float radius = 0.002f * static_cast<float>(1 + query);
    std::vector<std::uint32_t> found;
    store.tree().blocksInBall(center, radius, found);
    for (std::size_t i = 0; i < store.size(); ++i) {
      const auto q = store.position(i);
      const double distance = std::hypot(q[0] - center[0], q[1] - center[1], q[2] - center[2]);
      if (distance < radius - 1e-6) {
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(),
                                       static_cast<std::uint32_t>(i / PointStore::kBlock)));
      }
    }
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/point_store.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** A part of a view. */
CloudView partOf(const CloudView& view, std::size_t begin, std::size_t end) {
  CloudView part = view;
  part.xyz = static_cast<const char*>(view.xyz) + begin * view.xyz_stride;
  if (view.normal != nullptr)
    part.normal = static_cast<const char*>(view.normal) + begin * view.normal_stride;
  part.size = end - begin;
  return part;
}

StoreFrame frameInPieces(const CloudView& view, std::size_t piece, detail::FrameCounts& counts) {
  detail::FrameMeasure measure;
  do {
    for (std::size_t begin = 0; begin < view.size; begin += piece)
      measure.add(partOf(view, begin, std::min(view.size, begin + piece)), 2);
  } while (measure.needsAnotherPass());
  StoreFrame frame;
  const Error error = measure.finish(frame, counts);
  EXPECT_FALSE(error) << error.message;
  return frame;
}

void expectFrameOf(const PointStore& store, const StoreFrame& frame,
                   const detail::FrameCounts& counts) {
  EXPECT_EQ(frame.origin, store.origin());
  EXPECT_EQ(frame.scale, store.scale());
  EXPECT_EQ(frame.diagonal, store.diagonal());
  EXPECT_EQ(frame.bulk_diagonal, store.bulkDiagonal());
  EXPECT_EQ(frame.center_grid, store.centerGrid());
  EXPECT_EQ(frame.with_normals, store.hasNormals());
  EXPECT_EQ(counts.stored, store.size() + store.statistics().duplicates);
  EXPECT_EQ(counts.input - counts.finite, store.statistics().non_finite);
  EXPECT_EQ(counts.finite - counts.near, store.statistics().far_away);
}

TEST(StoreFrame, OfPiecesIsThatOfOneStore) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 20000, 0.01);
  const PointStore store = storeOf(cloud);
  detail::FrameCounts counts;
  expectFrameOf(store, frameInPieces(cloud.view(), 777, counts), counts);
}

TEST(StoreFrame, LeavesOutWhatAStoreLeavesOut) {
  Cloud cloud = sceneCloud(measure::Shape::kTorus, 20000, 0.01);
  cloud.points[3 * 5 + 1] = std::numeric_limits<double>::quiet_NaN();
  cloud.points[3 * 600] = 1e9;  // a stray
  ASSERT_FALSE(cloud.normals.empty());
  std::fill_n(cloud.normals.begin() + 3 * 700, 3, 0.0f);
  const PointStore store = storeOf(cloud);
  ASSERT_EQ(store.statistics().far_away, 1u);
  ASSERT_EQ(store.statistics().without_normal, 1u);
  detail::FrameCounts counts;
  const StoreFrame frame = frameInPieces(cloud.view(), 5000, counts);
  expectFrameOf(store, frame, counts);
  const auto again = PointStore::build(cloud.view(), frame, 1);
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->size(), store.size());
  for (std::size_t i = 0; i < store.size(); ++i) EXPECT_EQ(again->position(i), store.position(i));
}

TEST(StoreFrame, APartHasTheKeysThatItHasInTheWhole) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 20000, 0.01);
  const PointStore whole = storeOf(cloud);
  detail::FrameCounts counts;
  const StoreFrame frame = frameInPieces(cloud.view(), 20000, counts);
  const auto part = PointStore::build(partOf(cloud.view(), 3000, 9000), frame, 1);
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_EQ(part->size(), 6000u);
  for (std::size_t i = 0; i < part->size(); ++i)
    EXPECT_TRUE(std::binary_search(whole.keys(), whole.keys() + whole.size(), part->keys()[i]));
}

TEST(StoreFrame, IndicesWithoutStrays) {
  Cloud cloud = sceneCloud(measure::Shape::kTorus, 5000, 0.01);
  EXPECT_TRUE(withoutStrays(cloud.view(), 2).empty()) << "there are none";
  cloud.points[3 * 5 + 1] = std::numeric_limits<double>::quiet_NaN();
  cloud.points[3 * 600] = 1e9;
  const std::vector<std::int32_t> kept = withoutStrays(cloud.view(), 1);
  ASSERT_EQ(kept.size(), 4999u) << "the point that is not finite stays";
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_FALSE(std::binary_search(kept.begin(), kept.end(), 600));
  EXPECT_EQ(withoutStrays(cloud.view(), 4), kept);
  CloudView some = cloud.view();
  const std::vector<std::int32_t> indices(kept.rbegin(), kept.rend());
  some.indices = indices.data();
  some.num_indices = indices.size();
  EXPECT_TRUE(withoutStrays(some, 2).empty());
}

}  // namespace

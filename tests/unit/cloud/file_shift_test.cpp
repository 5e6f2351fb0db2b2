// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/store_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim {
namespace {

TEST(FileShift, IsZeroUnlessTheCloudIsFarAway) {
  const std::array<double, 3> none{};
  EXPECT_EQ(fileShift({-1, -1, -1}, {1, 1, 1}), none);
  EXPECT_EQ(fileShift({500, 0, 0}, {502, 2, 1}), none);
  const auto shift = fileShift({500000, 4900000, 10}, {500100, 4900050, 40});
  EXPECT_NE(shift, none);
  EXPECT_NEAR(shift[0], 500050, 260);
  EXPECT_NEAR(shift[1], 4900025, 260);
  EXPECT_EQ(std::fmod(shift[0], 512), 0.0) << "four times the diagonal of 116, rounded up";
}

TEST(FileShift, IsThatOfTheStoreWhateverIsTakenFromIt) {
  std::vector<double> xyz;
  for (int i = 0; i < 400; ++i)
    xyz.insert(xyz.end(), {3e5 + i % 20, 5e6 + 2 * (i / 20), 100 + 0.1 * (i % 7)});
  xyz[3] = std::numeric_limits<double>::quiet_NaN();
  CloudView view;
  view.xyz = xyz.data();
  view.xyz_stride = 24;
  view.scalar = CloudView::Scalar::kDouble;
  view.size = xyz.size() / 3;
  const auto store = PointStore::build(view);
  ASSERT_TRUE(store);
  EXPECT_EQ(fileShift(view), fileShift(store->origin(), store->scale()));
  EXPECT_NE(fileShift(view), (std::array<double, 3>{}));
  view.size = 0;
  EXPECT_EQ(fileShift(view), (std::array<double, 3>{}));
}

}  // namespace
}  // namespace pcl_slim

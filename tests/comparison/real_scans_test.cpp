// SPDX-License-Identifier: BSD-3-Clause
// Scans and their clean originals, where $PCL_SLIM_DATA has them.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "sweep.h"

namespace {

using namespace pcl_slim_test;

class RealScans : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override
  {
    const char* folder = std::getenv("PCL_SLIM_DATA");
    const std::string base = std::string(folder ? folder : "") + "/" + GetParam();
    const std::string noisy = base + "_noisy.ply", original = base + "_original.ply";
    if (!std::filesystem::exists(noisy) || !std::filesystem::exists(original)) {
      GTEST_SKIP() << "no " << noisy << " with its original";
    }
    auto made = pcl_slim::comparison::loadScene(GetParam(), noisy, original);
    ASSERT_TRUE(made) << made.error().message;
    scene_ = *made;
  }

  Scene scene_;
};

TEST_P(RealScans, DefaultOrSharpIsBelowBestOfMls)
{
  std::vector<Setting> radii;
  for (const int order : {2, 3}) {
    for (const int k : {15, 20, 30, 45, 60}) radii.push_back(mls(order, k));
  }
  const Errors rival = bestOf(scene_, radii);
  const Errors ours = bestOf(scene_, {slim(true), sharpSlim()});
  EXPECT_LT(ours.position, rival.position);
  EXPECT_LT(ours.normal, rival.normal);
}

INSTANTIATE_TEST_SUITE_P(Pairs, RealScans, testing::Values("julius_02", "fandisk_03", "block_04"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace

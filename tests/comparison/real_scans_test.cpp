// SPDX-License-Identifier: BSD-3-Clause
// Scans and their clean originals, where $PCL_SLIM_DATA has them.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "sweep.h"

namespace {

using namespace pcl_slim_test;

/** A pair, and the RMS error in mean edges that the sharp setting shall not exceed. */
struct Pair {
  const char* name;
  double sharp;
};

class RealScans : public testing::TestWithParam<Pair> {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PCL_SLIM_DATA");
    const std::string base = std::string(folder ? folder : "") + "/" + GetParam().name;
    const std::string noisy = base + "_noisy.ply", original = base + "_original.ply";
    if (!std::filesystem::exists(noisy) || !std::filesystem::exists(original)) {
      GTEST_SKIP() << "no " << noisy << " with its original";
    }
    auto made = pcl_slim::comparison::loadScene(GetParam().name, noisy, original);
    ASSERT_TRUE(made) << made.error().message;
    scene_ = *made;
  }

  Scene scene_;
};

TEST_P(RealScans, DefaultOrSharpIsBelowBestOfMls) {
  std::vector<Setting> radii;
  for (const int order : {2, 3}) {
    for (const int k : {15, 20, 30, 45, 60}) radii.push_back(mls(order, k));
  }
  const Errors rival = bestOf(scene_, radii);
  const Errors ours = bestOf(scene_, {slim(true), sharpSlim()});
  EXPECT_LE(errorsOf(scene_, sharpSlim()).position, GetParam().sharp);
  EXPECT_LT(ours.position, rival.position);
  EXPECT_LT(ours.normal, rival.normal);
}

INSTANTIATE_TEST_SUITE_P(Pairs, RealScans,
                         testing::Values(Pair{"julius_02", 0.088}, Pair{"fandisk_03", 0.114},
                                         Pair{"block_04", 0.162}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace

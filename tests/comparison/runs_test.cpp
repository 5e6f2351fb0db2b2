// SPDX-License-Identifier: BSD-3-Clause
// The comparison itself: both sides are measured by one honest rule, and odd input is refused.
#include <cmath>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"
#include "sweep.h"

namespace {

using namespace pcl_slim_test;
using pcl_slim::comparison::loadScene;
using pcl_slim::comparison::makeScene;

TEST(ComparisonRuns, CurvaturesHaveTheTruthsSignForBothMethods) {
  const auto scene = makeScene("torus", 10000, 0);
  ASSERT_TRUE(scene);
  // A wrong sign shows as a relative error of 2.
  EXPECT_LT(errorsOf(*scene, mls(2, 30)).curvature, 0.1);
  EXPECT_LT(errorsOf(*scene, slim(true)).curvature, 0.01);
  EXPECT_LT(errorsOf(*scene, slim(false)).curvature, 0.01);
}

TEST(ComparisonRuns, PointsWithoutResultCountWhereTheyStood) {
  const auto scene = makeScene("sphere", 3000, 0.01);
  ASSERT_TRUE(scene);
  double input = 0;
  for (std::size_t i = 0; i < scene->size(); ++i) {
    const auto& p = (*scene->points)[i];
    input += std::pow(scene->truth(i, {p.x, p.y, p.z}).distance, 2);
  }
  input = std::sqrt(input / static_cast<double>(scene->size()));
  // Fewer than three neighbours nearly everywhere: MLS drops the points.
  Scene sparse = *scene;
  sparse.spacing *= 1e-3;
  const auto run = runSetting(sparse, mls(2, 15));
  ASSERT_TRUE(run);
  EXPECT_EQ(run->kept, scene->size());
  EXPECT_NEAR(run->errors.position, input, 1e-9);
  EXPECT_TRUE(std::isnan(run->errors.normal));
}

TEST(ComparisonRuns, MlsRadiusHoldsTheNeighboursNamed) {
  const auto scene = makeScene("relief", 10000, 0);
  ASSERT_TRUE(scene);
  // Area of the relief, measured: 4.27 to three digits; evenly spread, so spacing is known.
  EXPECT_NEAR(scene->spacing, std::sqrt(4.27 / 10000), 0.05 * scene->spacing);
}

TEST(ComparisonRuns, CubeHasTruthInsideOutsideAndAtItsEdges) {
  const auto scene = makeScene("cube", 100, 0);
  ASSERT_TRUE(scene);
  EXPECT_NEAR(scene->truth(0, {0.9, 0, 0}).distance, -0.1, 1e-12);
  EXPECT_NEAR(scene->truth(0, {1.3, 1.4, 0}).distance, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(scene->truth(0, {0, -1.2, 0.5}).normal[1], -1);
  for (std::size_t i = 0; i < scene->size(); ++i) {
    const auto& p = (*scene->points)[i];
    EXPECT_NEAR(scene->truth(i, {p.x, p.y, p.z}).distance, 0, 1e-7);
  }
}

TEST(ComparisonRuns, OddInputIsRefusedInOneSentence) {
  EXPECT_FALSE(makeScene("teapot", 1000, 0));
  EXPECT_FALSE(loadScene("none", "no_such_file.ply", "no_such_file.ply"));
  const auto scene = makeScene("sphere", 1000, 0);
  ASSERT_TRUE(scene);
  EXPECT_FALSE(runSetting(*scene, mls(2, 2)));
  EXPECT_FALSE(runSetting(*scene, mls(0, 20)));
  Scene bare = *scene;
  bare.normals.clear();
  const auto run = runSetting(bare, slim(true));
  ASSERT_FALSE(run);
  EXPECT_NE(run.error().message.find("sphere has no normals"), std::string::npos);
}

class PointFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& points, int count) {
    const std::string path = folder_ / name;
    std::ofstream(path) << "ply\nformat ascii 1.0\nelement vertex " << count
                        << "\nproperty double x\nproperty double y\nproperty double z\n"
                        << "end_header\n"
                        << points;
    return path;
  }

  pcl_slim_test::TemporaryFolder folder_;
};

TEST_F(PointFiles, TruthMustHaveAsManyPoints) {
  const auto scene =
      loadScene("pair", write("a.ply", "0 0 0\n1 0 0\n", 2), write("b.ply", "0 0 0\n", 1));
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("2 points"), std::string::npos);
}

TEST_F(PointFiles, NonFinitePointsAreLeftOutAndLargeCoordinatesKeepTheirDigits) {
  const auto scene =
      loadScene("pair", write("a.ply", "nan 0 0\n500000.001 4000000 7\n500001 4000000 7.25\n", 3),
                write("b.ply", "0 0 0\n500000 4000000 7\n500001 4000000 7\n", 3));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->size(), 2u);
  const auto& p = (*scene->points)[0];
  EXPECT_NEAR(scene->truth(0, {p.x, p.y, p.z}).distance, 0.001, 1e-6);
  EXPECT_FLOAT_EQ((*scene->points)[1].z, 0.25f);
  EXPECT_FALSE(scene->has_true_normals);
}

TEST_F(PointFiles, NothingFiniteIsRefused) {
  const std::string file = write("a.ply", "nan 0 0\n", 1);
  EXPECT_FALSE(loadScene("pair", file, file));
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_deviation.h"

#include <gtest/gtest.h>
#include <pcl/conversions.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>

#include "door_suite.h"
#include "pcl_slim/filters/slim_fit.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Plain = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Plain>;
using Output = pcl::PointCloud<PointDeviation>;

constexpr double kSheetNoise = 0.002;

/** The surface of another scan of the suite's sphere. */
std::shared_ptr<const SLIMSurface> otherSphere() {
  static const auto made = [] {
    SLIMFit<Plain> fit;
    fit.setInputCloud(bumpySphere<Plain>(4000, 7));
    auto surface = std::make_shared<SLIMSurface>();
    EXPECT_TRUE(fit.fit(*surface)) << fit.getError().message;
    return surface;
  }();
  return made;
}

template <typename PointT>
struct DeviationDoor {
  using Point = PointT;
  using Door = SLIMDeviation<PointT>;
  static constexpr bool kPrints = false;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    door.setReference(otherSphere());
    Output made(3, 1);
    const bool done = door.compute(made);
    output.clear();
    for (const PointDeviation& p : made) {
      if (!std::isfinite(p.x)) continue;
      const auto* bytes = reinterpret_cast<const unsigned char*>(&p);
      output.insert(output.end(), bytes, bytes + sizeof(p));
    }
    return done;
  }
};

using Doors = testing::Types<DeviationDoor<Plain>, DeviationDoor<pcl::PointNormal>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Deviation, DoorSuite, Doors);

/** Points of a wavy sheet [-1, 1]^2 with noise, seen from above. \param[in] lift added to z. */
template <typename Lift>
Cloud::Ptr sheet(std::size_t count, unsigned seed, const Lift& lift, double size = 1.0) {
  auto cloud = std::make_shared<Cloud>();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-size, size);
  std::normal_distribution<double> noise(0.0, kSheetNoise);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random);
    const double z = 0.1 * std::sin(3 * x) * std::cos(2 * y) + lift(x, y) + noise(random);
    cloud->push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  }
  cloud->sensor_origin_ = {0.0f, 0.0f, 10.0f, 0.0f};
  return cloud;
}

double flat(double, double) {
  return 0.0;
}

/** The square [-1, 1]^2 at a height, two triangles that face up. */
pcl::PolygonMesh::Ptr square(float z) {
  const Cloud corners = [z] {
    Cloud cloud;
    for (const auto& [x, y] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}})
      cloud.push_back({x, y, z});
    return cloud;
  }();
  auto mesh = std::make_shared<pcl::PolygonMesh>();
  pcl::toPCLPointCloud2(corners, mesh->cloud);
  pcl::Vertices face;
  face.vertices = {0, 1, 2, 3};
  mesh->polygons.push_back(face);
  return mesh;
}

TEST(SLIMDeviation, IsTheDistanceToTheTrianglesOfAMesh) {
  auto cloud = std::make_shared<Cloud>();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.3, 1.3);
  std::normal_distribution<double> noise(0.0, kSheetNoise);
  for (int i = 0; i < 5000; ++i) {
    cloud->push_back({static_cast<float>(place(random)), static_cast<float>(place(random)),
                      static_cast<float>(0.3 + noise(random))});
  }
  cloud->sensor_origin_ = {0.0f, 0.0f, 10.0f, 0.0f};
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(cloud);
  deviation.setReference(square(0.0f));
  Output output;
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  ASSERT_EQ(output.size(), cloud->size());
  EXPECT_FALSE(output.is_dense);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < output.size(); ++i) {
    const Plain& p = (*cloud)[i];
    const bool over = std::abs(p.x) < 0.999 && std::abs(p.y) < 0.999;
    const bool beyond = std::abs(p.x) > 1.001 || std::abs(p.y) > 1.001;
    if (over) {
      EXPECT_NEAR(output[i].deviation, 0.3, kSheetNoise) << i;
      EXPECT_EQ(output[i].significant, 1) << i;
      EXPECT_GT(output[i].level_of_detection, 0.0f);
      EXPECT_LT(output[i].level_of_detection, 2 * kSheetNoise);
    }
    if (beyond) {
      ++outside;
      EXPECT_EQ(output[i].significant, -1) << i;
      EXPECT_TRUE(std::isnan(output[i].deviation) && std::isnan(output[i].level_of_detection));
    }
  }
  EXPECT_GT(outside, 1000u);
  const DeviationFigures& figures = deviation.getSummary().total;
  EXPECT_NEAR(figures.mean, 0.3, 0.001);
  EXPECT_EQ(figures.no_counterpart.places, output.size() - figures.measured.places);
  EXPECT_NEAR(figures.all.area, 2.6 * 2.6, 0.15);
  EXPECT_NEAR(figures.volume_up, 0.3 * 4, 0.04);
}

TEST(SLIMDeviation, RegistrationErrorRaisesTheLevel) {
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(4000, 1, flat));
  deviation.setReference(sheet(4000, 2, flat));
  Output plain, raised;
  ASSERT_TRUE(deviation.compute(plain)) << deviation.getError().message;
  deviation.setRegistrationError(0.01);
  ASSERT_TRUE(deviation.compute(raised)) << deviation.getError().message;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain[i].significant < 0) continue;
    EXPECT_NEAR(raised[i].level_of_detection - plain[i].level_of_detection, 1.96 * 0.01, 1e-5);
    EXPECT_EQ(raised[i].deviation, plain[i].deviation);
  }
}

TEST(SLIMDeviation, FindsAShallowDentAndItsVolume) {
  constexpr double kDepth = 0.02, kRadius = 0.35;
  const auto dent = [](double x, double y) {
    const double t = (x * x + y * y) / (kRadius * kRadius);
    return t < 1 ? -kDepth * (1 - t) * (1 - t) : 0.0;
  };
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(20000, 1, dent));
  deviation.setReference(sheet(20000, 2, flat));
  Output output;
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  std::size_t deep = 0, found = 0, far = 0, wrong = 0;
  double worst = 0;
  for (const PointDeviation& p : output) {
    const double r = std::hypot(p.x, p.y);
    if (r < 0.5 * kRadius) {
      ++deep;
      found += p.significant == 1 && p.deviation < 0;
      worst = std::max(worst, std::abs(p.deviation - dent(p.x, p.y)));
    }
    if (r > 1.3 * kRadius && std::abs(p.x) < 0.9 && std::abs(p.y) < 0.9) {
      ++far;
      wrong += p.significant == 1;
    }
  }
  EXPECT_GT(static_cast<double>(found), 0.99 * static_cast<double>(deep));
  // 5 % of what is unchanged, of some 60 leaves whose points share an error: +- 2.8 %.
  EXPECT_LT(static_cast<double>(wrong), (0.05 + 2 * 0.028) * static_cast<double>(far));
  EXPECT_LT(worst, 3 * kSheetNoise);
  // The integral of the dent: pi r^2 depth / 3; the rim is not significant.
  const double volume = std::acos(-1.0) * kRadius * kRadius * kDepth / 3;
  EXPECT_NEAR(deviation.getSummary().total.significant_volume_down, volume, 0.1 * volume);
}

TEST(SLIMDeviation, AlignUndoesAMotion) {
  const auto before = sheet(8000, 1, flat), after = sheet(8000, 2, flat);
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
  motion.translate(Eigen::Vector3d(0.01, -0.006, 0.015));
  motion.rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 3).normalized()));
  for (Plain& p : *after)
    p.getVector3fMap() = (motion * p.getVector3fMap().cast<double>()).cast<float>();
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(after);
  deviation.setReference(before);
  Output output;
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_EQ(deviation.getTransformation(), Eigen::Matrix4d::Identity());
  const double moved = deviation.getSummary().total.rms;
  EXPECT_GT(moved, 0.01);
  deviation.setAlign(true);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_LT(deviation.getSummary().total.rms, 0.1 * moved);
  const Eigen::Matrix4d left = deviation.getTransformation() * motion.matrix();
  EXPECT_LT((left.block<3, 1>(0, 3)).norm(), 0.002);
  EXPECT_LT((left.block<3, 3>(0, 0) - Eigen::Matrix3d::Identity()).norm(), 0.003);
}

TEST(SLIMDeviation, ReferencesOfEachKindCountAndTheLastOneDoes) {
  const auto reference = sheet(4000, 2, flat);
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(4000, 1, flat));
  Output output, same;
  EXPECT_FALSE(deviation.compute(output));
  EXPECT_NE(deviation.getError().message.find("setReference()"), std::string::npos);
  deviation.setReference(square(0.0f));
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_FALSE(deviation.getFittedReference());
  deviation.setReference(reference);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  ASSERT_TRUE(deviation.getFittedReference());
  const SLIMSurface fitted = *deviation.getFittedReference();
  deviation.setReference(fitted);
  ASSERT_TRUE(deviation.compute(same)) << deviation.getError().message;
  EXPECT_FALSE(deviation.getFittedReference());
  ASSERT_EQ(output.size(), same.size());
  for (std::size_t i = 0; i < output.size(); ++i) {
    EXPECT_EQ(output[i].significant, same[i].significant);
    if (output[i].significant < 0) continue;
    EXPECT_EQ(output[i].deviation, same[i].deviation);
  }
}

TEST(SLIMDeviation, MeasuredPlacesKeepTheirNoise) {
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(6000, 1, flat));
  deviation.setReference(sheet(6000, 2, flat));
  Output output;
  deviation.setPlaces(ScanPlaces::kMeasured);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_NEAR(deviation.getSummary().total.rms, kSheetNoise, 0.15 * kSheetNoise);
  for (const PointDeviation& p : output)
    EXPECT_NEAR(p.sigma_position, kSheetNoise, 0.1 * kSheetNoise);
  deviation.setPlaces(ScanPlaces::kMoved);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_LT(deviation.getSummary().total.rms, 0.5 * kSheetNoise);
}

TEST(SLIMDeviation, ToleranceGivesAVerdict) {
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(4000, 1, [](double, double) { return 0.02; }));
  deviation.setReference(sheet(4000, 2, flat));
  Output output;
  deviation.setTolerance(-0.03, 0.03);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_TRUE(deviation.getSummary().passes);
  deviation.setTolerance(-0.005, 0.005);
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  EXPECT_FALSE(deviation.getSummary().passes);
  deviation.setTolerance(1.0, -1.0);
  EXPECT_FALSE(deviation.compute(output));
  EXPECT_TRUE(output.empty());
  deviation.clearTolerance();
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
}

TEST(SLIMDeviation, MaxDistanceAndBadReferences) {
  SLIMDeviation<Plain> deviation;
  deviation.setInputCloud(sheet(2000, 1, [](double, double) { return 0.5; }));
  deviation.setReference(sheet(2000, 2, flat));
  deviation.setMaxDistance(0.1);
  Output output;
  ASSERT_TRUE(deviation.compute(output)) << deviation.getError().message;
  for (const PointDeviation& p : output) EXPECT_EQ(p.significant, -1);
  EXPECT_FALSE(deviation.getWarning().empty());  // the registration is unknown
  deviation.setMaxDistance(-1);
  EXPECT_FALSE(deviation.compute(output));
  deviation.setMaxDistance(0);
  deviation.setReference(std::make_shared<pcl::PolygonMesh>());
  EXPECT_FALSE(deviation.compute(output));
  EXPECT_NE(deviation.getError().message.find("reference mesh"), std::string::npos);
  deviation.setReference(std::make_shared<Cloud>());
  EXPECT_FALSE(deviation.compute(output));
  EXPECT_NE(deviation.getError().message.find("the reference"), std::string::npos);
  deviation.setReference(SLIMSurface());
  EXPECT_FALSE(deviation.compute(output));
}

}  // namespace
}  // namespace pcl_slim

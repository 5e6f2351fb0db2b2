// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_projection_smoother.h"

#include <gtest/gtest.h>

#include "cloud_bytes.h"
#include "door_suite.h"
#include "exact_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <typename PointInT, typename PointOutT>
struct SmootherDoor {
  using Point = PointInT;
  using Door = SLIMProjectionSmoother<PointInT, PointOutT>;
  static constexpr bool kPrints = true;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    pcl::PointCloud<PointOutT> cloud(3, 1);
    door.process(cloud);
    EXPECT_EQ(static_cast<std::size_t>(cloud.width) * cloud.height, cloud.size());
    output = bytesOf(cloud);
    return !door.getError();
  }
};

/** An organized cloud as a camera at the origin sees it: a step in depth, holes, noise, colours. */
pcl::PointCloud<pcl::PointXYZRGB>::Ptr paintedCameraCloud() {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(160, 120);
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0.0f, 0.002f);
  for (unsigned row = 0; row < 120; ++row) {
    for (unsigned column = 0; column < 160; ++column) {
      const float a = (static_cast<float>(column) - 79.5f) / 130.0f;
      const float b = (static_cast<float>(row) - 59.5f) / 130.0f;
      const float z = (column < 70 ? 1.5f : 2.0f) + noise(random);
      auto& p = (*cloud)(column, row);
      p.getVector3fMap() = Eigen::Vector3f(a * z, b * z, z);
      if ((row / 10 + column / 10) % 9 == 0) p.x = p.y = p.z = kNan;
      p.r = static_cast<std::uint8_t>(column);
      p.g = static_cast<std::uint8_t>(row);
    }
  }
  cloud->is_dense = false;
  cloud->header.frame_id = "camera";
  cloud->header.stamp = 77;
  cloud->sensor_origin_ = Eigen::Vector4f(1, 2, 3, 0);
  cloud->sensor_orientation_ = Eigen::Quaternionf(0.5f, 0.5f, 0.5f, 0.5f);
  return cloud;
}

template <typename PointT, typename Distance>
double rms(const pcl::PointCloud<PointT>& cloud, const Distance& distance) {
  double sum_sq = 0.0;
  for (const PointT& p : cloud) sum_sq += distance(p) * distance(p);
  return std::sqrt(sum_sq / static_cast<double>(cloud.size()));
}

/** Noise left of noisy spheres and tori; normals given or not. */
template <typename PointT>
void expectNoiseGone() {
  constexpr double kSigma = 0.003;
  SLIMProjectionSmoother<PointT, pcl::PointNormal> smoother;
  pcl::PointCloud<pcl::PointNormal> out;
  const auto sphere = [](const auto& p) { return pcl_slim_test::sphereDistance(p, 1.0); };
  const auto torus = [](const auto& p) { return pcl_slim_test::torusDistance(p); };

  const auto noisy = sphereCloud<PointT>(30000, 1.0, kSigma);
  smoother.setInputCloud(noisy);
  smoother.process(out);
  ASSERT_EQ(out.size(), noisy->size()) << smoother.getError().message;
  EXPECT_NEAR(rms(*noisy, sphere), kSigma, 0.02 * kSigma);
  EXPECT_LT(rms(out, sphere), 0.2 * kSigma);
  EXPECT_NEAR(smoother.getRMSDisplacement(), kSigma, 0.05 * kSigma);
  EXPECT_LT(smoother.getMaxDisplacement(), 6.0 * kSigma);
  EXPECT_EQ(smoother.getProjectionStatistics().unsupported, 0u);
  for (const auto& p : out) {
    ASSERT_GT(p.getNormalVector3fMap().dot(p.getVector3fMap().normalized()), 0.99f);
    // 30 of 30000 points of the unit sphere fill a disc of radius r = .063: (r k)^2 / 24 = 1.7e-4.
    ASSERT_LT(p.curvature, 6e-4) << "surface variation";
  }

  smoother.setInputCloud(torusCloud<PointT>(30000, kSigma));
  smoother.process(out);
  EXPECT_LT(rms(out, torus), 0.2 * kSigma);
}

TEST(SLIMProjectionSmoother, TakesNoiseAwayWithoutNormals) {
  expectNoiseGone<pcl::PointXYZ>();
}

TEST(SLIMProjectionSmoother, TakesNoiseAwayWithNormals) {
  expectNoiseGone<pcl::PointNormal>();
}

TEST(SLIMProjectionSmoother, KeepsOrderShapeHeaderAndFields) {
  const auto cloud = paintedCameraCloud();
  SLIMProjectionSmoother<pcl::PointXYZRGB, pcl::PointXYZRGBNormal> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZRGBNormal> out;
  smoother.process(out);
  ASSERT_FALSE(smoother.getError()) << smoother.getError().message;
  ASSERT_EQ(out.width, 160u);
  ASSERT_EQ(out.height, 120u);
  EXPECT_FALSE(out.is_dense);
  EXPECT_EQ(out.header.frame_id, "camera");
  EXPECT_EQ(out.header.stamp, 77u);
  EXPECT_EQ(out.sensor_origin_, cloud->sensor_origin_);
  EXPECT_EQ(out.sensor_orientation_.coeffs(), cloud->sensor_orientation_.coeffs());
  std::size_t holes = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_EQ(out[i].rgba, (*cloud)[i].rgba);
    ASSERT_EQ(pcl::isFinite(out[i]), pcl::isFinite((*cloud)[i]));
    if (!pcl::isFinite(out[i])) {
      ++holes;
      ASSERT_TRUE(std::isnan(out[i].normal_x) && std::isnan(out[i].curvature));
      continue;
    }
    const float moved = (out[i].getVector3fMap() - (*cloud)[i].getVector3fMap()).norm();
    ASSERT_LT(moved, 0.02f) << "no point crosses the step of 0.5";
  }
  const auto& statistics = smoother.getProjectionStatistics();
  EXPECT_EQ(statistics.non_finite, holes);
  EXPECT_EQ(statistics.points, out.size());
  EXPECT_EQ(statistics.moved + statistics.unsupported + holes, out.size());
  EXPECT_GT(statistics.moved, 9 * (out.size() - holes) / 10);
}

TEST(SLIMProjectionSmoother, OnePointPerIndexInTheirOrder) {
  const auto cloud = paintedCameraCloud();
  auto indices = std::make_shared<pcl::Indices>();
  for (pcl::index_t i = 12000; i >= 0; i -= 2) indices->push_back(i);
  indices->push_back(10000);  // twice
  SLIMProjectionSmoother<pcl::PointXYZRGB> smoother;
  smoother.setInputCloud(cloud);
  smoother.setIndices(indices);
  pcl::PointCloud<pcl::PointXYZRGB> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), indices->size());
  EXPECT_EQ(out.height, 1u);
  std::size_t twin = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_EQ(out[i].rgba, (*cloud)[static_cast<std::size_t>((*indices)[i])].rgba);
    if ((*indices)[i] == 10000 && i + 1 < out.size()) twin = i;
  }
  ASSERT_TRUE(pcl::isFinite(out[twin]));
  EXPECT_EQ(out[twin].getVector3fMap(), out.back().getVector3fMap());
}

TEST(SLIMProjectionSmoother, EqualPointsMoveAlike) {
  auto cloud = sphereCloud<pcl::PointXYZ>(4000, 1.0, 0.004);
  for (std::size_t i = 0; i < 500; ++i) cloud->push_back((*cloud)[7 * i]);
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), 4500u);
  EXPECT_EQ(smoother.getInputStatistics().duplicates, 500u);
  for (std::size_t i = 0; i < 500; ++i) {
    ASSERT_EQ(out[4000 + i].getVector3fMap(), out[7 * i].getVector3fMap());
    ASSERT_NE(out[7 * i].getVector3fMap(), (*cloud)[7 * i].getVector3fMap());
  }
}

TEST(SLIMProjectionSmoother, OutliersKeepTheirPlaceAndAreListed) {
  auto cloud = sphereCloud<pcl::PointXYZ>(5000, 1.0, 0.001);
  const std::vector<Eigen::Vector3f> lone = {{0, 0, 3}, {1.7f, 1.7f, 0}};
  for (std::size_t i = 0; i < lone.size(); ++i) {
    cloud->insert(cloud->begin() + static_cast<std::ptrdiff_t>(1000 * (i + 1)),
                  pcl::PointXYZ(lone[i].x(), lone[i].y(), lone[i].z()));
  }
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointNormal> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), 5002u);
  EXPECT_TRUE(out.is_dense);
  EXPECT_EQ(out[1000].getVector3fMap(), lone[0]);
  EXPECT_EQ(out[2000].getVector3fMap(), lone[1]);
  for (const std::size_t i : {1000u, 2000u}) {
    EXPECT_NEAR(out[i].getNormalVector3fMap().norm(), 1.0f, 1e-5f) << "that of its neighbours";
  }
  const pcl::Indices& kept = smoother.getUnsupported();
  EXPECT_EQ(kept.size(), smoother.getProjectionStatistics().unsupported);
  EXPECT_LT(kept.size(), 10u);
  for (const pcl::index_t i : {1000, 2000}) {
    EXPECT_EQ(std::count(kept.begin(), kept.end(), i), 1);
  }

  auto indices = std::make_shared<pcl::Indices>();
  for (pcl::index_t i = 500; i < 5002; ++i) indices->push_back(i);
  smoother.setIndices(indices);
  smoother.process(out);
  const pcl::Indices& some = smoother.getUnsupported();
  EXPECT_EQ(std::count(some.begin(), some.end(), 1000), 1) << "indices of the input cloud";
}

TEST(SLIMProjectionSmoother, PointsWithoutNormalAmongOthersAreSmoothed) {
  auto cloud = sphereCloud<pcl::PointNormal>(20000, 1.0, 0.003);
  for (std::size_t i = 0; i < cloud->size(); i += 10) {
    auto& p = (*cloud)[i];
    p.normal_x = p.normal_y = p.normal_z = i % 20 == 0 ? kNan : 0.0f;
  }
  SLIMProjectionSmoother<pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointNormal> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), cloud->size());
  EXPECT_EQ(smoother.getInputStatistics().without_normal, 2000u);
  EXPECT_EQ(smoother.getProjectionStatistics().unsupported, 0u);
  EXPECT_LT(rms(out, [](const auto& p) { return pcl_slim_test::sphereDistance(p, 1.0); }), 6e-4);
  for (const auto& p : out) ASSERT_GT(p.getNormalVector3fMap().dot(p.getVector3fMap()), 0.9f);
}

TEST(SLIMProjectionSmoother, TheOutputMayBeTheInput) {
  auto cloud = sphereCloud<pcl::PointXYZ>(3000, 1.0, 0.003);
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> apart;
  smoother.process(apart);
  smoother.process(*cloud);
  EXPECT_EQ(bytesOf(apart), bytesOf(*cloud));
}

TEST(SLIMProjectionSmoother, ServesAsPclsBaseClass) {
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  pcl::CloudSurfaceProcessing<pcl::PointXYZ, pcl::PointNormal>& base = smoother;
  pcl::PointCloud<pcl::PointNormal> out(4, 1);
  base.process(out);
  EXPECT_TRUE(out.empty());
  base.setInputCloud(sphereCloud<pcl::PointXYZ>(1000, 1.0, 0.0));
  base.process(out);
  EXPECT_EQ(out.size(), 1000u);
}

TEST(SLIMProjectionSmoother, PointsThatAreNoSurfaceStayAndAreWarnedOf) {
  auto line = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (int i = 0; i < 500; ++i) {
    const auto t = static_cast<float>(i);
    line->push_back(pcl::PointXYZ(0.1f * t, 0.2f * t, 0.3f * t));
  }
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(line);
  pcl::PointCloud<pcl::PointXYZ> smooth;
  testing::internal::CaptureStderr();
  smoother.process(smooth);
  const std::string printed = testing::internal::GetCapturedStderr();
  EXPECT_FALSE(smoother.getError());
  EXPECT_NE(smoother.getWarning().find("along lines"), std::string::npos) << smoother.getWarning();
  EXPECT_EQ(printed.empty(), false);
  EXPECT_FALSE(smoother.getFittedSurface());
  EXPECT_EQ(smoother.getUnsupported().size(), line->size());
  ASSERT_EQ(smooth.size(), line->size());
  for (std::size_t i = 0; i < line->size(); ++i) {
    EXPECT_EQ(smooth[i].getVector3fMap(), (*line)[i].getVector3fMap());
  }
  smoother.setInputCloud(bumpySphere<pcl::PointXYZ>(500));
  smoother.process(smooth);
  EXPECT_EQ(smoother.getWarning().find("along lines"), std::string::npos) << smoother.getWarning();
  EXPECT_NE(smoother.getWarning().find("sides: outward"), std::string::npos)
      << smoother.getWarning();
  smoother.setViewPoint(0, 0, 5);
  smoother.process(smooth);
  EXPECT_TRUE(smoother.getWarning().empty()) << smoother.getWarning();
}

TEST(SLIMProjectionSmoother, BadParametersAreErrors) {
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(bumpySphere<pcl::PointXYZ>(300));
  pcl::PointCloud<pcl::PointXYZ> out;
  smoother.setPolynomialOrder(9);
  smoother.process(out);
  EXPECT_EQ(smoother.getError().code, ErrorCode::kBadArgument);
  EXPECT_TRUE(out.empty());
  smoother.setPolynomialOrder(2);
  smoother.setInputNormals(std::make_shared<pcl::PointCloud<pcl::Normal>>(7, 1));
  smoother.process(out);
  EXPECT_EQ(smoother.getError().code, ErrorCode::kBadInput);
  smoother.setInputNormals(nullptr);
  smoother.setNormalEstimationNeighbors(2);
  smoother.process(out);
  EXPECT_TRUE(smoother.getError());
}

TEST(SLIMProjectionSmoother, KeepsTheSensorsNoise) {
  const auto smoothed = [](SLIMProjectionSmoother<pcl::PointXYZ>& smoother, unsigned seed,
                           double noise) {
    smoother.setInputCloud(sphereCloud<pcl::PointXYZ>(20000, 1.0, noise, seed));
    pcl::PointCloud<pcl::PointXYZ> out;
    smoother.process(out);
    EXPECT_FALSE(smoother.getError()) << smoother.getError().message;
    return rms(out, [](const auto& p) { return std::hypot(p.x, p.y, p.z) - 1.0; });
  };
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setKeepSensorNoise(true);
  smoothed(smoother, 1, 0.01);
  ASSERT_TRUE(smoother.getSensorNoise().has_value());
  const SensorNoise noise = *smoother.getSensorNoise();
  EXPECT_NEAR(noise.error[0], 0.01, 0.0005);
  EXPECT_LT(smoothed(smoother, 2, 0.01), 0.003);
  EXPECT_EQ(smoother.getStatistics().noise.sensor_check, SensorCheck::kAgrees);
  EXPECT_EQ(*smoother.getSensorNoise(), noise);
  smoothed(smoother, 3, 0.02);
  EXPECT_EQ(smoother.getStatistics().noise.sensor_check, SensorCheck::kDiffers);
  EXPECT_NEAR(smoother.getSensorNoise()->error[0], 0.02, 0.001);

  SLIMProjectionSmoother<pcl::PointXYZ> other;
  other.setSensorNoise(noise);
  smoothed(other, 2, 0.01);
  EXPECT_EQ(other.getStatistics().noise.sensor_check, SensorCheck::kAgrees);
  EXPECT_EQ(*other.getSensorNoise(), noise);
}

TEST(SLIMProjectionSmoother, FarFromTheOriginFloatsSetTheLimit) {
  auto cloud = sphereCloud<pcl::PointXYZ>(8000, 1.0, 0.003);
  for (auto& p : *cloud) p.x += 1000.0f;
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> out;
  smoother.process(out);
  // A float near 1000 has steps of 6e-5.
  const auto distance = [](const auto& p) {
    return std::hypot(static_cast<double>(p.x) - 1000.0, p.y, p.z) - 1.0;
  };
  EXPECT_LT(rms(out, distance), 8e-4);
}

}  // namespace
}  // namespace pcl_slim

namespace pcl_slim_test {

using SmootherDoors =
    testing::Types<pcl_slim::SmootherDoor<pcl::PointXYZ, pcl::PointXYZ>,
                   pcl_slim::SmootherDoor<pcl::PointXYZRGBNormal, pcl::PointNormal>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SLIMProjectionSmoother, DoorSuite, SmootherDoors);

}  // namespace pcl_slim_test

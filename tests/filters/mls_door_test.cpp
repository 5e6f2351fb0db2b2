// SPDX-License-Identifier: BSD-3-Clause
// SLIMProjectionSmoother where pcl::MovingLeastSquares stood: the same calls, and what they give.
#include <gtest/gtest.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <cmath>
#include <random>

#include "exact_clouds.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::PointNormal>;
using Mls = pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal>;
using Slim = SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal>;

/** z = 0 over the unit square, with noise and a wave. */
Cloud::Ptr noisyPlane(std::size_t count, double noise, double wave = 0.0, double length = 1.0) {
  auto cloud = std::make_shared<Cloud>();
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = share(random), y = share(random);
    const double z = wave * std::sin(2 * M_PI * x / length) + noise * normal(random);
    cloud->push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  }
  return cloud;
}

double rmsHeight(const Normals& cloud) {
  double sum = 0, count = 0;
  for (const auto& p : cloud) {
    if (p.x < 0.1f || p.x > 0.9f || p.y < 0.1f || p.y > 0.9f) continue;
    sum += double{p.z} * p.z;
    count += 1;
  }
  return std::sqrt(sum / count);
}

double rmsFromSphere(const Normals& cloud, double radius) {
  double sum = 0;
  for (const auto& p : cloud) sum += std::pow(std::hypot(p.x, p.y, p.z) - radius, 2);
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

/** Every public member of pcl::MovingLeastSquares, versions 1.12 to 1.15, but process(). */
template <typename Smoother>
void callEverything(Smoother& mls, const Cloud::Ptr& cloud) {
  mls.setInputCloud(cloud);
  mls.setIndices(std::make_shared<pcl::Indices>(pcl::Indices{0, 1, 2}));
  mls.setComputeNormals(true);
  typename Smoother::KdTreePtr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  mls.setSearchMethod(tree);
  EXPECT_EQ(mls.getSearchMethod(), tree);
  mls.setPolynomialOrder(2);
  EXPECT_EQ(mls.getPolynomialOrder(), 2);
  mls.setSearchRadius(0.25);
  EXPECT_EQ(mls.getSearchRadius(), 0.25);
  EXPECT_EQ(mls.getSqrGaussParam(), 0.0625);
  mls.setSqrGaussParam(0.5);
  EXPECT_EQ(mls.getSqrGaussParam(), 0.5);
  for (const auto method : {Smoother::NONE, Smoother::DISTINCT_CLOUD, Smoother::SAMPLE_LOCAL_PLANE,
                            Smoother::RANDOM_UNIFORM_DENSITY, Smoother::VOXEL_GRID_DILATION}) {
    const typename Smoother::UpsamplingMethod named = method;
    mls.setUpsamplingMethod(named);
  }
  const typename Smoother::PointCloudInConstPtr distinct = cloud;
  mls.setDistinctCloud(distinct);
  EXPECT_EQ(mls.getDistinctCloud(), distinct);
  mls.setUpsamplingRadius(0.1);
  EXPECT_EQ(mls.getUpsamplingRadius(), 0.1);
  mls.setUpsamplingStepSize(0.02);
  EXPECT_EQ(mls.getUpsamplingStepSize(), 0.02);
  mls.setPointDensity(12);
  EXPECT_EQ(mls.getPointDensity(), 12);
  mls.setDilationVoxelSize(0.5f);
  EXPECT_EQ(mls.getDilationVoxelSize(), 0.5f);
  mls.setDilationIterations(3);
  EXPECT_EQ(mls.getDilationIterations(), 3);
  mls.setCacheMLSResults(true);
  EXPECT_TRUE(mls.getCacheMLSResults());
  mls.setProjectionMethod(pcl::MLSResult::ORTHOGONAL);
  EXPECT_EQ(mls.getProjectionMethod(), pcl::MLSResult::ORTHOGONAL);
  EXPECT_TRUE(mls.getMLSResults().empty());
  mls.setNumberOfThreads(1);
  const pcl::PointIndicesPtr none = mls.getCorrespondingIndices();
  EXPECT_FALSE(none);
}

/** The calls of PCL's tutorial on smoothing by resampling. */
template <typename Smoother>
Normals tutorial(const Cloud::Ptr& cloud, double radius) {
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  Normals points;
  Smoother mls;
  mls.setComputeNormals(true);
  mls.setInputCloud(cloud);
  mls.setPolynomialOrder(2);
  mls.setSearchMethod(tree);
  mls.setSearchRadius(radius);
  mls.process(points);
  return points;
}

TEST(MlsDoor, EveryMemberCompilesAndARunWarnsOfUnusedOnes) {
  const auto cloud = pcl_slim_test::noisySphere<pcl::PointXYZ>(10, 1.0, 0.0);
  Mls mls;
  callEverything(mls, cloud);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  Slim slim;
  callEverything(slim, cloud);
  const std::string printed =
      testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
  EXPECT_EQ(printed, "") << "setters print nothing";
  slim.setIndices(std::make_shared<pcl::Indices>(pcl::Indices{0, 1, 2, 3, 4}));
  slim.setUpsamplingMethod(Slim::NONE);
  testing::internal::CaptureStderr();
  Normals few;
  slim.process(few);
  const std::string warned = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(warned.begin(), warned.end(), '\n'), 1) << warned;
  EXPECT_NE(warned.find(slim.getWarning()), std::string::npos) << warned;
  EXPECT_NE(warned.find("setSqrGaussParam, setCacheMLSResults, setProjectionMethod"),
            std::string::npos)
      << warned;
  EXPECT_EQ(static_cast<int>(Mls::VOXEL_GRID_DILATION),
            static_cast<int>(Slim::VOXEL_GRID_DILATION));
  EXPECT_EQ(static_cast<int>(Mls::DISTINCT_CLOUD), static_cast<int>(Slim::DISTINCT_CLOUD));
}

TEST(MlsDoor, TheTutorialRunsWithTheNameChanged) {
  const auto cloud = pcl_slim_test::noisySphere<pcl::PointXYZ>(8000, 1.0, 0.01);
  const Normals theirs = tutorial<Mls>(cloud, 0.2), ours = tutorial<Slim>(cloud, 0.2);
  ASSERT_EQ(ours.size(), theirs.size());
  EXPECT_LE(rmsFromSphere(ours, 1.0), 1.05 * rmsFromSphere(theirs, 1.0));
  for (const auto& p : ours) {
    const double along = p.normal_x * p.x + p.normal_y * p.y + p.normal_z * p.z;
    ASSERT_GT(std::abs(along), 0.98);
  }
}

TEST(MlsDoor, ASearchRadiusSmoothsNoLessThanMls) {
  for (const double radius : {0.05, 0.1}) {
    for (const double noise : {1e-4, 0.005}) {
      const auto cloud = noisyPlane(20000, noise);
      const double theirs = rmsHeight(tutorial<Mls>(cloud, radius));
      EXPECT_LE(rmsHeight(tutorial<Slim>(cloud, radius)), 1.05 * theirs) << radius << ' ' << noise;
    }
  }
}

TEST(MlsDoor, DetailFinerThanTheSearchRadiusGoes) {
  const auto cloud = noisyPlane(20000, 1e-5, 0.002, 0.06);
  Slim slim;
  slim.setInputCloud(cloud);
  Normals kept, gone;
  slim.process(kept);
  EXPECT_GT(rmsHeight(kept), 0.0013);
  slim.setSearchRadius(0.1);
  slim.process(gone);
  EXPECT_LT(rmsHeight(gone), 0.15 * rmsHeight(kept));
  const SLIMSurface& surface = *slim.getFittedSurface();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    ASSERT_GE(surface.radius[i] * surface.info.scale, 0.999 * 0.197);
  }
  EXPECT_FALSE(slim.getParams().least_radius) << "the parameter set is the user's";
}

TEST(MlsDoor, CurvatureIsWhatIsAskedFor) {
  const auto cloud = pcl_slim_test::noisySphere<pcl::PointXYZ>(6000, 5.0, 0.0);
  Slim slim;
  slim.setInputCloud(cloud);
  slim.setSearchRadius(1.0);
  const std::pair<Slim::Curvature, double> kinds[] = {
      {Slim::kMean, 0.2}, {Slim::kGaussian, 0.04}, {Slim::kMaximum, 0.2}, {Slim::kMinimum, 0.2}};
  Normals smooth;
  for (const auto& [kind, wanted] : kinds) {
    slim.setCurvature(kind);
    slim.process(smooth);
    ASSERT_EQ(smooth.size(), cloud->size());
    double sum = 0;
    for (const auto& p : smooth) sum += std::abs(p.curvature);
    EXPECT_NEAR(sum / 6000, wanted, 0.02 * wanted);
  }
}

TEST(MlsDoor, PclsOwnPointTypesKeepTheirFields) {
  pcl::PointCloud<pcl::PointXYZL>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZL>);
  const auto plain = pcl_slim_test::noisySphere<pcl::PointXYZ>(2000, 1.0, 0.001);
  for (const auto& p : *plain) {
    pcl::PointXYZL q;
    q.x = p.x, q.y = p.y, q.z = p.z;
    q.label = static_cast<std::uint32_t>(cloud->size());
    cloud->push_back(q);
  }
  SLIMProjectionSmoother<pcl::PointXYZL, pcl::PointXYZLNormal> slim;
  slim.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZLNormal> out;
  slim.process(out);
  ASSERT_EQ(out.size(), cloud->size());
  EXPECT_EQ(out[77].label, 77u);
  EXPECT_NEAR(std::hypot(out[77].normal_x, out[77].normal_y, out[77].normal_z), 1, 1e-5);
  // Of the other pairs, one of each kind is linked.
  SLIMProjectionSmoother<pcl::PointXYZRGBL, pcl::PointSurfel> a;
  SLIMProjectionSmoother<pcl::PointXYZHSV, pcl::PointXYZLAB> b;
  SLIMProjectionSmoother<pcl::InterestPoint, pcl::PointDEM> c;
  SLIMProjectionSmoother<pcl::PointWithRange, pcl::PointWithViewpoint> d;
  SLIMProjectionSmoother<pcl::PointSurfel, pcl::PointWithScale> e;
  testing::internal::CaptureStderr();
  pcl::PointCloud<pcl::PointSurfel> nothing;
  a.process(nothing);
  EXPECT_TRUE(a.getError());
  testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace pcl_slim

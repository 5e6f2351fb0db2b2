// SPDX-License-Identifier: BSD-3-Clause
// PCL's filters, normals and searches before and behind this package's classes.
#include <gtest/gtest.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/passthrough.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/octree.h>

#include <cmath>
#include <memory>
#include <random>

#include "exact_clouds.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using PaintedPoint = pcl::PointXYZRGB;
using PaintedCloud = pcl::PointCloud<PaintedPoint>;
using Search = pcl::search::Search<PaintedPoint>;

constexpr double kNoise = 0.005;  ///< of the torus's points

/** A noisy torus, red and blue, with points far from it and a second one beyond the range. */
PaintedCloud::Ptr scannedTorus() {
  auto cloud = torusCloud<PaintedPoint>(60000, kNoise);
  for (PaintedPoint& p : *cloud) {
    p.r = p.x > 0 ? 220 : 20;
    p.g = 60;
    p.b = p.x > 0 ? 20 : 220;
  }
  const PaintedCloud near = *cloud;
  for (PaintedPoint p : near) {
    p.z += 5.0f;
    cloud->push_back(p);
  }
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-1.6f, 1.6f);
  for (int i = 0; i < 300; ++i) {
    PaintedPoint p;
    p.x = place(random);
    p.y = place(random);
    p.z = place(random);
    cloud->push_back(p);
  }
  return cloud;
}

PaintedCloud::Ptr cleaned(const PaintedCloud::Ptr& scan) {
  auto cloud = std::make_shared<PaintedCloud>(), thinned = std::make_shared<PaintedCloud>();
  pcl::PassThrough<PaintedPoint> pass;
  pass.setInputCloud(scan);
  pass.setFilterFieldName("z");
  pass.setFilterLimits(-2.0f, 2.0f);
  pass.filter(*cloud);
  pcl::VoxelGrid<PaintedPoint> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(0.02f, 0.02f, 0.02f);
  grid.filter(*thinned);
  pcl::StatisticalOutlierRemoval<PaintedPoint> apart;
  apart.setInputCloud(thinned);
  apart.setMeanK(16);
  apart.setStddevMulThresh(2.0);
  apart.filter(*cloud);
  return cloud;
}

/** RMS distance from the torus. */
template <typename PointT>
double errorOf(const pcl::PointCloud<PointT>& cloud) {
  double sum = 0.0;
  for (const PointT& p : cloud) {
    const double d = std::hypot(std::hypot(p.x, p.y) - kMajor, p.z) - kMinor;
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(PCLPipeline, CleansFitsSmoothsAndSamples) {
  const PaintedCloud::Ptr cloud = cleaned(scannedTorus());
  ASSERT_GT(cloud->size(), 20000u);
  const Search::Ptr tree(new pcl::search::KdTree<PaintedPoint>);
  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::NormalEstimationOMP<PaintedPoint, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(tree);
  estimation.setKSearch(16);
  estimation.compute(*normals);

  SLIMFit<PaintedPoint> fit;
  fit.setInputCloud(cloud);
  fit.setInputNormals(normals);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_TRUE(surface.hasColors());
  EXPECT_LT(surface.numLeaves(), cloud->size() / 10);

  SLIMProjectionSmoother<PaintedPoint, pcl::PointXYZRGBNormal> smoother;
  auto smooth = std::make_shared<pcl::PointCloud<pcl::PointXYZRGBNormal>>();
  smoother.setInputCloud(cloud);
  smoother.setInputNormals(normals);
  smoother.setSearchMethod(tree);
  smoother.process(*smooth);
  ASSERT_EQ(smooth->size(), cloud->size());
  // Some fifty points average their noise in a ball; single strays that the filter left are far
  // off.
  EXPECT_LT(errorOf(*smooth), 0.5 * errorOf(*cloud));

  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  sampler.setInputCloud(smooth);
  pcl::PointCloud<pcl::PointSurfel> splats;
  ASSERT_TRUE(sampler.sample(splats)) << sampler.getError().message;
  EXPECT_LT(splats.size(), cloud->size() / 5);
  // A disc is at the mean of its points, which are in a cap of up to 16 degrees.
  EXPECT_LT(errorOf(splats), kMinor * (1.0 - std::cos(16.0 * M_PI / 180.0)));
  std::size_t red = 0, blue = 0;
  for (const pcl::PointSurfel& p : splats) (p.r > p.b ? red : blue) += 1;
  EXPECT_GT(red, splats.size() / 3);
  EXPECT_GT(blue, splats.size() / 3);
}

TEST(PCLPipeline, SamplerEstimatesNormalsWithAnySearch) {
  const auto cloud = torusCloud<PaintedPoint>(20000, 0.0);
  ColorOctreeSplatSampler<PaintedPoint> sampler;
  sampler.setInputCloud(cloud);
  sampler.setNormalEstimationNeighbors(12);
  for (const Search::Ptr& search :
       {Search::Ptr(), Search::Ptr(new pcl::search::KdTree<PaintedPoint>),
        Search::Ptr(new pcl::search::Octree<PaintedPoint>(0.1))}) {
    sampler.setSearchMethod(search);
    EXPECT_EQ(sampler.getSearchMethod(), search);
    pcl::PointCloud<pcl::PointSurfel> splats;
    ASSERT_TRUE(sampler.sample(splats)) << sampler.getError().message;
    double worst = 1.0;
    for (const pcl::PointSurfel& p : splats) {
      const double ring = std::hypot(p.x, p.y), across = std::hypot(ring - kMajor, p.z);
      const double n[3] = {p.x / ring * (ring - kMajor) / across,
                           p.y / ring * (ring - kMajor) / across, p.z / across};
      worst = std::min(worst, std::abs(n[0] * p.normal_x + n[1] * p.normal_y + n[2] * p.normal_z));
    }
    // A cell's points are within a cap of 16 degrees, and so is their mean normal.
    EXPECT_GT(worst, std::cos(16.0 * M_PI / 180.0));
  }
  sampler.setSearchMethod(std::make_shared<pcl::search::KdTree<PaintedPoint>>());
  sampler.setNormalEstimationNeighbors(2);
  pcl::PointCloud<pcl::PointSurfel> none;
  EXPECT_FALSE(sampler.sample(none));
  EXPECT_NE(sampler.getError().message.find("neighbours"), std::string::npos);
}

}  // namespace
}  // namespace pcl_slim

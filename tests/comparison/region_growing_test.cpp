// SPDX-License-Identifier: BSD-3-Clause
// pcl::RegionGrowing, with the settings of PCL's tutorial, on what the smoother and
// pcl::MovingLeastSquares make of depth frames, where $PCL_SLIM_DATA has them.
#include <gtest/gtest.h>
#include <pcl/common/io.h>
#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>
#include <pcl/segmentation/impl/region_growing.hpp>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/pcl_conversion.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace {

using Frame = pcl::PointCloud<pcl::PointXYZ>;
using Smooth = pcl::PointCloud<pcl::PointNormal>;

/** A frame of a depth camera or a stereo pair, of which each step-th row and column is taken. */
struct FrameFile {
  const char* name;
  unsigned step;
};

// In these parts of frames .02 m have some 50 neighbours, of the 15 to 60 that MLS gets elsewhere.
constexpr double kMlsRadius = 0.02;

class RegionGrowing : public testing::TestWithParam<FrameFile> {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PCL_SLIM_DATA");
    const std::string path = std::string(folder ? folder : "") + "/" + GetParam().name + ".pcd";
    const auto file = pcl_slim::loadPointFile(path);
    if (!file) GTEST_SKIP() << "no " << path;
    Frame all;
    pcl_slim::toPCL(*file, all);
    const unsigned step = GetParam().step;
    frame_ = std::make_shared<Frame>(all.width / step, all.height / step);
    frame_->is_dense = false;
    frame_->sensor_origin_ = all.sensor_origin_;
    frame_->sensor_orientation_ = all.sensor_orientation_;
    for (unsigned row = 0; row < frame_->height; ++row) {
      for (unsigned column = 0; column < frame_->width; ++column) {
        (*frame_)(column, row) = all(column * step, row * step);
        finite_ += pcl::isXYZFinite((*frame_)(column, row)) ? 1 : 0;
      }
    }
  }

  Smooth byMls() const {
    auto points = std::make_shared<Frame>();
    for (const auto& p : *frame_)
      if (pcl::isXYZFinite(p)) points->push_back(p);
    pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
    mls.setInputCloud(points);
    mls.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
    mls.setComputeNormals(true);
    mls.setPolynomialOrder(2);
    mls.setSearchRadius(kMlsRadius);
    Smooth smooth;
    mls.process(smooth);
    return smooth;
  }

  Smooth bySlim() const {
    pcl_slim::SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
    smoother.setInputCloud(frame_);
    smoother.setNumberOfThreads(1);
    Smooth smooth;
    smoother.process(smooth);
    EXPECT_FALSE(smoother.getError()) << smoother.getError().message;
    return smooth;
  }

  /** The share of the frame's points that are in a cluster. \param[in] threshold of curvature, of
   * PCL's tutorial 1, by default .05 */
  double shareInClusters(const Smooth& smooth, float threshold) const {
    auto points = std::make_shared<Frame>();
    auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
    for (const auto& p : smooth) {
      if (!pcl::isXYZFinite(p)) continue;
      points->push_back({p.x, p.y, p.z});
      pcl::Normal& normal = normals->emplace_back(p.normal_x, p.normal_y, p.normal_z);
      normal.curvature = p.curvature;
    }
    pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
    growing.setMinClusterSize(50);
    growing.setMaxClusterSize(1000000);
    growing.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
    growing.setNumberOfNeighbours(30);
    growing.setInputCloud(points);
    growing.setInputNormals(normals);
    growing.setSmoothnessThreshold(static_cast<float>(3.0 / 180.0 * M_PI));
    growing.setCurvatureThreshold(threshold);
    std::vector<pcl::PointIndices> clusters;
    growing.extract(clusters);
    std::size_t found = 0;
    for (const auto& cluster : clusters) found += cluster.indices.size();
    return static_cast<double>(found) / static_cast<double>(finite_);
  }

  Frame::Ptr frame_;
  std::size_t finite_ = 0;
};

TEST_P(RegionGrowing, FindsNoFewerPointsInClustersThanAfterMls) {
  const Smooth ours = bySlim(), theirs = byMls();
  for (const auto& p : ours) {
    ASSERT_TRUE(!pcl::isXYZFinite(p) || std::abs(p.getNormalVector3fMap().norm() - 1) < 1e-4f)
        << "each point has a normal";
  }
  for (const float threshold : {1.0f, 0.05f})
    EXPECT_GE(shareInClusters(ours, threshold), shareInClusters(theirs, threshold)) << threshold;
  // The surface variation of smooth surfaces is below PCL's threshold: it takes no seed away.
  EXPECT_NEAR(shareInClusters(ours, 0.05f), shareInClusters(ours, 1.0f), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Frames, RegionGrowing,
                         testing::Values(FrameFile{"kinect_mosd_learn13", 2},
                                         FrameFile{"stereo_pr2_textured", 2},
                                         FrameFile{"azure_kinect_organized", 3}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "rivals/depth_images.h"

#include <pcl/features/integral_image_normal.h>
#include <pcl/filters/fast_bilateral.h>
#include <pcl/point_types.h>

namespace pcl_slim::rivals {

namespace {

pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOf(const DepthImage& image) {
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(image.points.size());
  for (const Vector3& p : image.points) {
    cloud->push_back(
        {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  cloud->width = static_cast<std::uint32_t>(image.columns);
  cloud->height = static_cast<std::uint32_t>(image.points.size() / image.columns);
  return cloud;
}

}  // namespace

std::vector<Vector3> smoothByBilateralFilter(const DepthImage& image, double sigma_s,
                                             double sigma_r) {
  pcl::FastBilateralFilter<pcl::PointXYZ> filter;
  filter.setInputCloud(cloudOf(image));
  filter.setSigmaS(static_cast<float>(sigma_s));
  filter.setSigmaR(static_cast<float>(sigma_r));
  pcl::PointCloud<pcl::PointXYZ> output;
  filter.filter(output);
  std::vector<Vector3> points;
  points.reserve(output.size());
  // It changes depths alone: each point is moved along its ray.
  for (std::size_t i = 0; i < output.size(); ++i)
    points.push_back(scaled(image.points[i], output[i].z / image.points[i][2]));
  return points;
}

std::vector<Vector3> normalsByIntegralImages(const DepthImage& image, double size) {
  pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setNormalEstimationMethod(estimation.AVERAGE_3D_GRADIENT);
  estimation.setMaxDepthChangeFactor(0.02f);
  estimation.setNormalSmoothingSize(static_cast<float>(size));
  estimation.setInputCloud(cloudOf(image));
  pcl::PointCloud<pcl::Normal> output;
  estimation.compute(output);
  std::vector<Vector3> normals;
  normals.reserve(output.size());
  for (const pcl::Normal& n : output) normals.push_back({n.normal_x, n.normal_y, n.normal_z});
  return normals;
}

}  // namespace pcl_slim::rivals

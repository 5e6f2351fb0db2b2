// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/pcl_normals.h"

#include <pcl/common/point_tests.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

pcl::search::Search<pcl::PointXYZ>::Ptr
makeSearch(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud)
{
  if (cloud->isOrganized()) {
    auto organized = std::make_shared<pcl::search::OrganizedNeighbor<pcl::PointXYZ>>();
    organized->setInputCloud(cloud);
    if (organized->isValid()) return organized;
  }
  auto tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
  tree->setInputCloud(cloud);
  return tree;
}

namespace {

// Squared distances in floats: neither infinite across the cloud nor zero between neighbours.
constexpr float kLargest = 1e18f;
constexpr float kLeastSpan = 1e-12f;

/** What of PCL's normals cannot be had for a cloud. */
Error
checkCloud(const pcl::PointCloud<pcl::PointXYZ>& cloud, int neighbours)
{
  float largest = 0, low[3] = {}, high[3] = {};
  std::size_t finite = 0;
  for (const pcl::PointXYZ& p : cloud) {
    if (!pcl::isFinite(p)) continue;
    for (int a = 0; a < 3; ++a) {
      largest = std::max(largest, std::abs(p.data[a]));
      low[a] = finite == 0 ? p.data[a] : std::min(low[a], p.data[a]);
      high[a] = finite == 0 ? p.data[a] : std::max(high[a], p.data[a]);
    }
    ++finite;
  }
  if (neighbours < 3 || static_cast<std::size_t>(neighbours) > finite) {
    return {ErrorCode::kBadArgument, "normals from " + std::to_string(neighbours) +
                                         " neighbours of " + std::to_string(finite) +
                                         " points: give a number from 3 to that of the points"};
  }
  const float span = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  if (largest <= kLargest && (span >= kLeastSpan || span == 0.0f)) return {};
  return badInput("PCL's normals take squares of coordinates in floats, which these are too " +
                  std::string(largest > kLargest ? "large" : "small") + " for: scale the cloud");
}

}  // namespace

Error
pclNormals(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud,
           const pcl::IndicesConstPtr& selected,
           const pcl::search::Search<pcl::PointXYZ>::Ptr& search, int neighbours,
           const FitParams& params, pcl::PointCloud<pcl::Normal>& normals)
{
  if (Error error = checkThreads(params.threads)) return error;
  if (Error error = checkCloud(*cloud, neighbours)) return error;
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(
      static_cast<unsigned int>(resolveThreads(params.threads)));
  estimation.setInputCloud(cloud);
  estimation.setIndices(selected);
  estimation.setSearchMethod(search);
  estimation.setKSearch(neighbours);
  if (params.has_viewpoint) {
    estimation.setViewPoint(static_cast<float>(params.viewpoint[0]),
                            static_cast<float>(params.viewpoint[1]),
                            static_cast<float>(params.viewpoint[2]));
  } else if (cloud->sensor_origin_.head<3>().allFinite()) {
    estimation.useSensorOriginAsViewPoint();
  }
  estimation.compute(normals);
  return {};
}

void
faceSensors(const CloudView& view, std::vector<float>& normals)
{
  for (std::size_t i = 0; i < view.size; ++i) {
    const auto from = view.position(i), sensor = view.sensorPosition(i);
    float* n = &normals[3 * i];
    double along = 0;
    for (std::size_t a = 0; a < 3; ++a) along += (sensor[a] - from[a]) * n[a];
    for (std::size_t a = 0; a < 3 && along < 0; ++a) n[a] = -n[a];
  }
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/scene_points.h"

#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace pcl_slim::comparison {

pcl::PointCloud<pcl::PointXYZ>::Ptr
toCloud(const std::vector<double>& xyz)
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(xyz.size() / 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    cloud->push_back(pcl::PointXYZ(static_cast<float>(xyz[i]), static_cast<float>(xyz[i + 1]),
                                   static_cast<float>(xyz[i + 2])));
  }
  return cloud;
}

double
spacingOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& clean)
{
  constexpr int kNeighbours = 10;
  const std::size_t stride = std::max<std::size_t>(1, clean->size() / 2000);
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(clean);
  pcl::Indices found;
  std::vector<float> squared, tenth;
  for (std::size_t i = 0; i < clean->size(); i += stride) {
    if (tree.nearestKSearch((*clean)[i], kNeighbours + 1, found, squared) <= kNeighbours) continue;
    tenth.push_back(squared.back());
  }
  if (tenth.empty()) return 0;
  std::nth_element(tenth.begin(), tenth.begin() + tenth.size() / 2, tenth.end());
  return std::sqrt(tenth[tenth.size() / 2] * M_PI / kNeighbours);
}

}  // namespace pcl_slim::comparison

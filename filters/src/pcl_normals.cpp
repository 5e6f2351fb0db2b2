// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/pcl_normals.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

#include <memory>

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

void
pclNormals(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud,
           const pcl::IndicesConstPtr& selected,
           const pcl::search::Search<pcl::PointXYZ>::Ptr& search, int neighbours,
           const FitParams& params, pcl::PointCloud<pcl::Normal>& normals)
{
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
  } else {
    estimation.useSensorOriginAsViewPoint();
  }
  estimation.compute(normals);
}

}  // namespace pcl_slim

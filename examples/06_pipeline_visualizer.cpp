// SPDX-License-Identifier: BSD-3-Clause
// PCL's filters and normals before, pcl_slim in the middle, PCLVisualizer at the end: a coloured
// scan is cut to a box, thinned, cleaned, fitted, smoothed and drawn as a surface beside splats.
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/passthrough.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/search/kdtree.h>
#include <pcl/visualization/pcl_visualizer.h>
#include <pcl_slim/filters/color_octree_splat_sampler.h>
#include <pcl_slim/filters/slim_fit.h>
#include <pcl_slim/filters/slim_projection_smoother.h>
#include <pcl_slim/visualization/pcl_visualizer.h>

#include <cstdlib>
#include <iostream>
#include <limits>
#include <string>

using Point = pcl::PointXYZRGB;
using Cloud = pcl::PointCloud<Point>;

/** The points within Z of the sensor, one for each cell of a grid, without those that stand apart.
 */
Cloud::Ptr cleaned(const Cloud::Ptr& scan, float far, float leaf) {
  auto cloud = std::make_shared<Cloud>();
  pcl::PassThrough<Point> pass;
  pass.setInputCloud(scan);
  pass.setFilterFieldName("z");
  pass.setFilterLimits(std::numeric_limits<float>::lowest(), far);
  pass.filter(*cloud);

  pcl::VoxelGrid<Point> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(leaf, leaf, leaf);
  auto thinned = std::make_shared<Cloud>();
  grid.filter(*thinned);

  pcl::StatisticalOutlierRemoval<Point> apart;
  apart.setInputCloud(thinned);
  apart.setMeanK(16);
  apart.setStddevMulThresh(2.0);
  apart.filter(*cloud);
  return cloud;
}

/** Cloud, surface and splats side by side, seen from the sensor. */
void show(const Cloud::Ptr& cloud, const pcl_slim::SLIMSurface& surface,
          const pcl::PointCloud<pcl::PointSurfel>& splats,
          pcl::visualization::PCLVisualizer& viewer) {
  viewer.setSize(1500, 380);
  int left = 0, middle = 0, right = 0;
  viewer.createViewPort(0.0, 0.0, 1.0 / 3, 1.0, left);
  viewer.createViewPort(1.0 / 3, 0.0, 2.0 / 3, 1.0, middle);
  viewer.createViewPort(2.0 / 3, 0.0, 1.0, 1.0, right);
  viewer.setBackgroundColor(1.0, 1.0, 1.0);
  viewer.addPointCloud<Point>(cloud, "cloud", left);
  pcl_slim::addSLIMSurface(viewer, surface, "surface", middle);
  pcl_slim::addSplats(viewer, splats, "splats", right);
  viewer.setCameraPosition(0, 0, 0, 0, 0, 1, 0, -1, 0);
  viewer.resetCamera();
  viewer.setCameraFieldOfView(0.35);
}

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "Syntax is: " << argv[0] << " scan.pcd FAR LEAF [picture.png]\n";
    return 2;
  }
  auto scan = std::make_shared<Cloud>();
  if (pcl::io::loadPCDFile(argv[1], *scan) < 0) return 2;
  const Cloud::Ptr cloud =
      cleaned(scan, std::strtof(argv[2], nullptr), std::strtof(argv[3], nullptr));

  const pcl::search::Search<Point>::Ptr tree(new pcl::search::KdTree<Point>);
  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::NormalEstimationOMP<Point, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setSearchMethod(tree);
  estimation.setKSearch(16);
  estimation.compute(*normals);

  pcl_slim::SLIMFit<Point> fit;
  pcl_slim::SLIMSurface surface;
  fit.setInputCloud(cloud);
  fit.setInputNormals(normals);
  if (!fit.fit(surface)) {
    std::cerr << fit.getError().message << "\n";
    return 1;
  }

  pcl_slim::SLIMProjectionSmoother<Point, pcl::PointXYZRGBNormal> smoother;
  auto smooth = std::make_shared<pcl::PointCloud<pcl::PointXYZRGBNormal>>();
  smoother.setInputCloud(cloud);
  smoother.setInputNormals(normals);
  smoother.setSearchMethod(tree);
  smoother.process(*smooth);

  pcl_slim::ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  pcl::PointCloud<pcl::PointSurfel> splats;
  sampler.setInputCloud(smooth);
  if (!sampler.sample(splats)) {
    std::cerr << sampler.getError().message << "\n";
    return 1;
  }
  std::cout << scan->size() << " points, " << cloud->size() << " cleaned, " << surface.numLeaves()
            << " leaves, " << splats.size() << " splats\n";

  pcl::visualization::PCLVisualizer viewer("Cloud, surface, splats");
  show(cloud, surface, splats, viewer);
  if (argc > 4) {
    viewer.spinOnce(100);
    viewer.saveScreenshot(argv[4]);
    return 0;
  }
  viewer.spin();
}

// SPDX-License-Identifier: BSD-3-Clause
// Shows a fitted surface in a PCLVisualizer, coloured by its mean curvature.
#include <pcl/io/pcd_io.h>
#include <pcl/visualization/pcl_visualizer.h>
#include <pcl_slim/filters/slim_fit.h>
#include <pcl_slim/visualization/pcl_visualizer.h>

#include <iostream>
#include <string>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "Syntax is: " << argv[0] << " scan.pcd\n";
    return 2;
  }
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (pcl::io::loadPCDFile(argv[1], *cloud) < 0) return 2;

  pcl_slim::SLIMFit<pcl::PointXYZ> fit;
  pcl_slim::SLIMSurface surface;
  fit.setInputCloud(cloud);
  if (!fit.fit(surface)) {
    std::cerr << fit.getError().message << "\n";
    return 1;
  }
  pcl::visualization::PCLVisualizer viewer("The surface of " + std::string(argv[1]));
  viewer.setBackgroundColor(1.0, 1.0, 1.0);
  viewer.setSize(800, 600);
  pcl_slim::addSLIMSurface(viewer, surface, "surface");
  pcl_slim::setSLIMSurfaceMode(viewer, pcl_slim::DisplayMode::kMean, 0.0, "surface");

  viewer.resetCamera();
  viewer.spin();
}

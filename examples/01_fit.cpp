// SPDX-License-Identifier: BSD-3-Clause
// Fits a SLIM surface to a cloud and saves it as points that every PCL program opens.
#include <pcl/io/pcd_io.h>
#include <pcl_slim/filters/io/surface_files.h>
#include <pcl_slim/filters/slim_fit.h>

#include <cmath>
#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "Syntax is: " << argv[0] << " scan.pcd surface.slim\n";
    return 2;
  }
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (pcl::io::loadPCDFile(argv[1], *cloud) < 0) return 2;

  pcl_slim::SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  fit.setPolynomialOrder(3);

  pcl_slim::SLIMSurface surface;
  if (!fit.fit(surface)) {
    std::cerr << fit.getError().message << "\n";
    return 1;
  }
  std::cout << cloud->size() << " points became " << surface.numLeaves() << " leaves of "
            << surface.numLevels() << " levels; noise is about "
            << std::sqrt(fit.getStatistics().lambda) * 100 << " % of the diagonal\n";

  if (const pcl_slim::Error error = pcl_slim::saveSurface(argv[2], surface)) {
    std::cerr << error.message << "\n";
    return 1;
  }
}

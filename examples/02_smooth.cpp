// SPDX-License-Identifier: BSD-3-Clause
// Smooths a cloud where one would use pcl::MovingLeastSquares, and writes it with normals.
#include <pcl/io/pcd_io.h>
#include <pcl_slim/filters/slim_projection_smoother.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "Syntax is: " << argv[0] << " scan.pcd smooth.pcd\n";
    return 2;
  }
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (pcl::io::loadPCDFile(argv[1], *cloud) < 0) return 2;

  pcl_slim::SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointNormal> smooth;
  smoother.process(smooth);  // says what is wrong, if anything is
  if (smoother.getError()) return 1;

  std::cout << smooth.size() << " points, moved by " << smoother.getRMSDisplacement()
            << " (root mean square), " << smoother.getMaxDisplacement() << " at most; "
            << smoother.getUnsupported().size() << " outliers kept their place\n";
  return pcl::io::savePCDFileBinary(argv[2], smooth) < 0 ? 1 : 0;
}

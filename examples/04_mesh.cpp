// SPDX-License-Identifier: BSD-3-Clause
// Makes a triangle mesh of a cloud where one would use pcl::Poisson, and writes it with curvatures.
#include <pcl/io/pcd_io.h>
#include <pcl_slim/filters/io/mesh_files.h>
#include <pcl_slim/filters/slim_reconstruction.h>

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "Syntax is: " << argv[0] << " scan.pcd mesh.ply\n";
    return 2;
  }
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (pcl::io::loadPCDFile(argv[1], *cloud) < 0) return 2;

  pcl_slim::SLIMReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);  // says what is wrong, if anything is
  if (reconstruction.getError()) return 1;

  const pcl_slim::MeshCensus& census = reconstruction.getMeshStatistics().census;
  std::cout << census.triangles << " triangles, " << census.components << " components, "
            << census.border_edges << " border edges\n";
  // The mesh beside the pcl::PolygonMesh has doubles, normals and curvatures.
  const pcl_slim::Error error = pcl_slim::saveMesh(argv[2], reconstruction.getMesh());
  if (error) std::cerr << error.message << '\n';
  return error ? 1 : 0;
}

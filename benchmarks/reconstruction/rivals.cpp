// SPDX-License-Identifier: BSD-3-Clause
#include "reconstruction/rivals.h"

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

namespace pcl_slim::reconstruction_bench {

namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;

Cloud::Ptr cloudOf(const measure::Scene& scene) {
  Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    pcl::PointNormal p;
    for (std::size_t a = 0; a < 3; ++a) {
      p.data[a] = static_cast<float>(scene.points[i + a]);
      p.data_n[a] = scene.normals[i + a];
    }
    cloud->push_back(p);
  }
  return cloud;
}

/** Vertices get the normals of the triangles about them. */
Error adopt(const pcl::PolygonMesh& from, TriangleMesh& mesh) {
  pcl::PointCloud<pcl::PointXYZ> points;
  pcl::fromPCLPointCloud2(from.cloud, points);
  mesh.clear();
  for (const auto& p : points) mesh.vertices.push_back({p.x, p.y, p.z});
  std::vector<Vector3> normals(points.size(), Vector3{});
  for (const auto& polygon : from.polygons) {
    for (std::size_t k = 2; k < polygon.vertices.size(); ++k) {
      const std::array<std::uint32_t, 3> t = {static_cast<std::uint32_t>(polygon.vertices[0]),
                                              static_cast<std::uint32_t>(polygon.vertices[k - 1]),
                                              static_cast<std::uint32_t>(polygon.vertices[k])};
      mesh.triangles.push_back(t);
      const Vector3 area = cross(subtract(mesh.vertices[t[1]], mesh.vertices[t[0]]),
                                 subtract(mesh.vertices[t[2]], mesh.vertices[t[0]]));
      for (const std::uint32_t v : t) normals[v] = along(normals[v], 1, area);
    }
  }
  for (const Vector3& n : normals) {
    const Vector3 unit = normalized(n);
    mesh.normals.push_back(
        {static_cast<float>(unit[0]), static_cast<float>(unit[1]), static_cast<float>(unit[2])});
  }
  if (mesh.triangles.empty()) return badInput("no triangles came out");
  return {};
}

}  // namespace

Error poisson(const measure::Scene& scene, int depth, TriangleMesh& mesh) {
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(depth);
  poisson.setInputCloud(cloudOf(scene));
  pcl::PolygonMesh made;
  poisson.reconstruct(made);
  return adopt(made, mesh);
}

Error greedyProjection(const measure::Scene& scene, double spacing, TriangleMesh& mesh) {
  pcl::GreedyProjectionTriangulation<pcl::PointNormal> greedy;
  const Cloud::Ptr cloud = cloudOf(scene);
  const pcl::search::KdTree<pcl::PointNormal>::Ptr tree(new pcl::search::KdTree<pcl::PointNormal>);
  tree->setInputCloud(cloud);
  greedy.setSearchRadius(4 * spacing);
  greedy.setMu(2.5);
  greedy.setMaximumNearestNeighbors(100);
  greedy.setMaximumSurfaceAngle(M_PI / 4);
  greedy.setMinimumAngle(M_PI / 18);
  greedy.setMaximumAngle(2 * M_PI / 3);
  greedy.setInputCloud(cloud);
  greedy.setSearchMethod(tree);
  pcl::PolygonMesh made;
  greedy.reconstruct(made);
  return adopt(made, mesh);
}

}  // namespace pcl_slim::reconstruction_bench

// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <iterator>

#include "borders/reconstructions.h"

namespace pcl_slim::borders {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/** \brief CGAL's own priority, the smallest radius first, of triangles with short edges. */
struct ShortEdges {
  double longest;

  template <typename Front, typename Cell>
  double operator()(const Front& front, Cell& cell, const int& index) const {
    double most_sq = 0.0;
    for (int k = 1; k < 4; ++k) {
      const auto& a = cell->vertex((index + k) % 4)->point();
      const auto& b = cell->vertex((index + k % 3 + 1) % 4)->point();
      most_sq = std::max(most_sq, CGAL::to_double(CGAL::squared_distance(a, b)));
    }
    return most_sq > longest * longest ? front.infinity()
                                       : front.smallest_radius_delaunay_sphere(cell, index);
  }
};

}  // namespace

Error advancingFront(const OpenScene& scene, TriangleMesh& mesh) {
  constexpr double kLongest = 5.0;
  std::vector<Kernel::Point_3> points;
  for (const Vector3& p : scene.points) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::array<std::size_t, 3>> facets;
  CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(),
                                               std::back_inserter(facets), ShortEdges{kLongest});
  mesh.clear();
  mesh.vertices = scene.points;
  mesh.normals.assign(mesh.vertices.size(), {0.0f, 0.0f, 1.0f});
  for (const auto& f : facets) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(f[0]), static_cast<std::uint32_t>(f[1]),
                              static_cast<std::uint32_t>(f[2])});
  }
  if (mesh.triangles.empty()) return badInput("CGAL found no surface");
  return {};
}

}  // namespace pcl_slim::borders

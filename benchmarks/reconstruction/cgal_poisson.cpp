// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <map>
#include <utility>

#include "reconstruction/rivals.h"

namespace pcl_slim::reconstruction_bench {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointWithNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;

bool hasCgal() {
  return true;
}

Error cgalPoisson(const measure::Scene& scene, double spacing, TriangleMesh& mesh) {
  std::vector<PointWithNormal> points;
  for (std::size_t i = 0; i < scene.points.size(); i += 3) {
    points.emplace_back(
        Kernel::Point_3(scene.points[i], scene.points[i + 1], scene.points[i + 2]),
        Kernel::Vector_3(scene.normals[i], scene.normals[i + 1], scene.normals[i + 2]));
  }
  CGAL::Polyhedron_3<Kernel> made;
  if (!CGAL::poisson_surface_reconstruction_delaunay(
          points.begin(), points.end(), CGAL::First_of_pair_property_map<PointWithNormal>(),
          CGAL::Second_of_pair_property_map<PointWithNormal>(), made, spacing)) {
    return badInput("CGAL found no surface");
  }
  mesh.clear();
  std::map<const void*, std::uint32_t> number;
  for (auto v = made.vertices_begin(); v != made.vertices_end(); ++v) {
    number[&*v] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({v->point().x(), v->point().y(), v->point().z()});
    mesh.normals.push_back({0, 0, 1});
  }
  for (auto f = made.facets_begin(); f != made.facets_end(); ++f) {
    auto edge = f->halfedge();
    mesh.triangles.push_back({number[&*edge->vertex()], number[&*edge->next()->vertex()],
                              number[&*edge->next()->next()->vertex()]});
  }
  return {};
}

}  // namespace pcl_slim::reconstruction_bench

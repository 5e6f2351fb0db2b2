// SPDX-License-Identifier: BSD-3-Clause
// CGAL's part of the gallery (scripts/gallery.sh): cgal_peer METHOD SCAN.ply OUT.ply. METHOD is
//   tutorial     what CGAL's tutorial on reconstruction does: 5 % of the points are left out as outliers, one is kept in
//                each cell of twice the spacing, jets of 24 neighbours smooth them and give normals, Poisson
//   scale_space  all points; four scales smoothed by jets, triangles of the advancing front whose edges are at most six
//                spacings long
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_mesh_io.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/IO/read_points.h>
#include <CGAL/Point_set_3.h>
#include <CGAL/Point_set_3/IO.h>
#include <CGAL/Scale_space_reconstruction_3/Advancing_front_mesher.h>
#include <CGAL/Scale_space_reconstruction_3/Jet_smoother.h>
#include <CGAL/Scale_space_surface_reconstruction_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/grid_simplify_point_set.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/jet_smooth_point_set.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/remove_outliers.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Points = CGAL::Point_set_3<Kernel::Point_3, Kernel::Vector_3>;
using Parallel = CGAL::Parallel_if_available_tag;
constexpr int kNeighbours = 24;
constexpr int kScales = 4;

template <typename Iterator>
void dropFrom(Points& points, Iterator first) {
  points.remove(first, points.end());
  points.collect_garbage();
}

bool poisson(Points points, const char* path) {
  dropFrom(points, CGAL::remove_outliers<Parallel>(points, kNeighbours,
                                                   points.parameters().threshold_percent(5.0)));
  const double spacing = CGAL::compute_average_spacing<Parallel>(points, 6);
  dropFrom(points, CGAL::grid_simplify_point_set(points, 2.0 * spacing));
  CGAL::jet_smooth_point_set<Parallel>(points, kNeighbours);
  CGAL::jet_estimate_normals<Parallel>(points, kNeighbours);
  dropFrom(points, CGAL::mst_orient_normals(points, kNeighbours));
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  return CGAL::poisson_surface_reconstruction_delaunay(points.begin(), points.end(),
                                                       points.point_map(), points.normal_map(),
                                                       mesh, spacing) &&
         CGAL::IO::write_PLY(path, mesh);
}

bool scaleSpace(const Points& points, const char* path) {
  const double spacing = CGAL::compute_average_spacing<Parallel>(points, 6);
  CGAL::Scale_space_surface_reconstruction_3<Kernel> space(points.points().begin(),
                                                           points.points().end());
  space.increase_scale(kScales,
                       CGAL::Scale_space_reconstruction_3::Jet_smoother<Kernel, Parallel>());
  space.reconstruct_surface(
      CGAL::Scale_space_reconstruction_3::Advancing_front_mesher<Kernel>(6 * spacing));
  const std::vector<Kernel::Point_3> vertices(space.points_begin(), space.points_end());
  std::vector<std::vector<std::size_t>> faces;
  for (auto facet = space.facets_begin(); facet != space.facets_end(); ++facet) {
    faces.push_back({(*facet)[0], (*facet)[1], (*facet)[2]});
  }
  return CGAL::IO::write_polygon_soup(path, vertices, faces);
}

}  // namespace

int main(int argc, char** argv) {
  Points points;
  if (argc != 4 || !CGAL::IO::read_point_set(argv[2], points)) {
    std::fprintf(stderr, "usage: cgal_peer tutorial|scale_space SCAN.ply OUT.ply\n");
    return 2;
  }
  // The tutorial estimates normals, also of scans that have them.
  points.remove_normal_map();
  points.add_normal_map();
  const bool done =
      std::string(argv[1]) == "tutorial" ? poisson(points, argv[3]) : scaleSpace(points, argv[3]);
  return done ? 0 : 1;
}

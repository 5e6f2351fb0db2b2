// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surface_components.h"

namespace pcl_slim {

/** \brief How a surface becomes triangles. */
struct PCL_SLIM_EXPORT MeshParams {
  /** Largest distance between mesh and surface [world units]; 0: a quarter of the noise's standard
   * deviation, and at least 1e-4 of the diagonal. Vertices are not nearer to each other than about
   * the spacing of the points, or half of it for a smaller tolerance than that: an error that
   * remains then is larger. */
  double tolerance = 0;
  bool trim = true;  ///< end the mesh where the data end: by the surface's trim maps
  /** Holes of the mesh are closed unless a disc of this diameter has room between the points around
   * [spacings of the points]; 0: all stay open. The ends of open sheets stay open. */
  double hole_size = 6;
  /** Every border loop is closed, whatever its size and shape, so that the mesh is a body: holes by
   * surfaces that continue what is around them, the end of an open sheet or pipe by a membrane
   * across it. */
  bool watertight = false;
  /** Components of the surface with fewer points are left out, as dropComponents() does, and then
   * the pieces of the mesh that contouring makes where leaves disagree: those whose area times the
   * density that the surface's leaves report is below it, or below .4 of it where the surface has
   * several components; 0: all stay. */
  double min_component_points = kLeastComponentPoints;
  int relax = 2;  ///< rounds of tangential smoothing of the triangles; 0 to 100
  /** Edges are collapsed, those of least error first, until there are no more triangles; 0: no
   * limit. The tolerance is then not kept. */
  std::uint64_t max_triangles = 0;
  /** A second fit to the same points, with FitParams::sharp_features: the mesh gets its sharp
   * edges. Vertices are put onto its nearest face, and vertices are added where its faces differ by
   * more than 40 degrees; their curvatures are 0. Null: edges are as round as the surface. Must
   * outlive the extraction. */
  const SLIMSurface* sharp = nullptr;
  int threads = 0;  ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What an extraction did and what it left out. */
struct MeshStatistics {
  MeshCensus census;
  double tolerance = 0;            ///< as used [world units]
  std::uint64_t cells = 0;         ///< of the octree that contain surface
  std::uint64_t corners = 0;       ///< places at which distances were evaluated
  std::uint64_t split_cells = 0;   ///< to keep the topology
  std::uint64_t collapsed = 0;     ///< triangles removed for max_triangles
  std::uint64_t rounds = 0;        ///< of contouring
  std::uint64_t unprojected = 0;   ///< vertices that no leaf supports: they stay where edges cross
  std::uint64_t closed_gaps = 0;   ///< of the contouring: places where leaves disagree too much
  std::uint64_t closed_holes = 0;  ///< border loops closed: small holes, or with watertight all
  double closed_area = 0;          ///< of the triangles that close them [world units squared]
  double area = 0;                 ///< of all triangles [world units squared]
  std::uint64_t border_loops = 0;  ///< of the mesh
  std::uint64_t sheet_ends = 0;    ///< of these: around a sheet, not around a hole in it
  double longest_loop = 0;         ///< [world units]
  double widest_hole = 0;          ///< of the other loops: a larger hole_size closes them all
  DroppedComponents left_out;      ///< of the surface, before it was triangulated
  std::uint64_t dropped = 0;       ///< triangles of components left out
  std::uint64_t dropped_components = 0;
  std::uint64_t edge_vertices = 0;    ///< added where two faces of the sharp surface meet
  std::uint64_t corner_vertices = 0;  ///< added where three meet
  double seconds_tree = 0, seconds_contour = 0, seconds_vertices = 0, seconds_trim = 0,
         seconds_sharpen = 0, seconds_simplify = 0;
};

/** \brief Triangulates a SLIM surface by dual contouring (Ju, Losasso, Schaefer, Warren 2002) on an
 * octree whose cells follow the leaves' curvature; one vertex for each sheet of surface in a cell,
 * put onto the surface by equations (6) and (7) of Ohtake, Belyaev, Alexa 2005.
 *
 * Closed surfaces give closed meshes; where a surface has trim maps the mesh ends on their border.
 * Holes that are narrower than requested are closed, whatever their reason. What closes a hole has
 * no curvature.
 * Every edge has at most two triangles. Triangles face the side of the surface's normals; those of
 * an unoriented surface agree within each component where that is possible.
 *
 * \return an error for parameters out of range, an empty or invalid surface, a tolerance that needs
 * more than 2^30 cells, or cancellation; the mesh is then empty. Same bytes for any number of
 * threads. O(triangles + leaves).
 */
PCL_SLIM_EXPORT Error extractMesh(const SLIMSurface& surface, const MeshParams& params,
                                  TriangleMesh& mesh, MeshStatistics* statistics = nullptr,
                                  Progress* progress = nullptr);

}  // namespace pcl_slim

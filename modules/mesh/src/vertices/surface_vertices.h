// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "contour/contour.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_extraction.h"

namespace pcl_slim::detail {

/** Vertices on the surface, local units. */
struct SurfaceVertices {
  std::vector<Vector3> position, normal;
  std::vector<float> k1, k2;
  std::vector<float> outside;           ///< share of the trim maps: the surface ends at 1/2
  std::vector<float> size;              ///< of cells about
  std::vector<std::uint8_t> on_border;  ///< 1: moved to where the surface ends
  std::vector<std::uint8_t> supported;  ///< 0: not on the surface, but where cells' edges cross it

  std::size_t count() const { return position.size(); }
  void resize(std::size_t count);
};

/** Puts each vertex onto the surface next to it (equations 6 and 7, twice), along its normal's
 * side. Those that no leaf supports, or that would leave their cells, stay. O(vertices times leaves
 * near each). */
void putOnSurface(const ProbeField& field, std::vector<std::uint32_t> which,
                  SurfaceVertices& vertices);

/** Moves vertices towards the middle of those they are connected to, along the surface, in several
 * passes. A vertex stays where a triangle would turn over; so do those on borders. */
void relax(const ProbeField& field, const std::vector<Triangle>& triangles, int rounds,
           SurfaceVertices& vertices);

/** A plane through a place, with a unit normal. */
struct Plane {
  Vector3 place, normal;
};

/** The place nearest to another at which two or three planes meet. \return false: they are nearly
 * parallel. */
bool meetingOf(const Plane* planes, std::size_t count, const Vector3& near, Vector3& place);

/** Gives a mesh of a rounded surface the sharp edges of another fit to the same points.
 *
 * Each vertex is put onto the nearest face of the sharp surface. An edge of the mesh whose ends are
 * then on faces that part by more than 40 degrees gets a vertex where these faces meet, and a
 * triangle between three faces gets one at their corner, as in Attene, Falcidieno, Rossignac,
 * Spagnuolo: Sharpen&Bend (IEEE TVCG 2005). What is manifold stays so. New vertices have the mean
 * normal of their faces and no curvature.
 * \param[in] sharp oriented, of a fit with FitParams::sharp_features. \param[in,out] vertices in
 * its local units. The same for any number of threads. O(vertices times leaves near each). */
void sharpen(const SLIMSurface& sharp, int threads, std::vector<Triangle>& triangles,
             SurfaceVertices& vertices, MeshStatistics& statistics);

/** Collapses edges of a manifold mesh until it has a given number of triangles or fewer, those of
 * least quadric error first (Garland, Heckbert: Surface simplification using quadric error metrics,
 * SIGGRAPH 1997). What would change the topology, or turn a triangle over, is not collapsed;
 * borders stay where they are. Vertices that no triangle names are left over. O(T log T), in one
 * thread. */
void collapseEdges(std::size_t most_triangles, std::vector<Triangle>& triangles,
                   SurfaceVertices& vertices);

/** Takes away triangles without area, by collapsing their shortest edge or flipping their longest
 * one, where the mesh stays manifold and nothing turns over; else one corner moves off the longest
 * edge. Then triangles with two edges on the border that fold back onto the mesh are taken away. O(T).
 */
void cleanTriangles(std::vector<Triangle>& triangles, SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Closes gaps that contouring has left where the surface goes on: border loops of few edges, on whose area fewer
 * points would lie than on a disc `width` spacings wide, with data on all sides. A gap of three edges gets a
 * triangle, others a fan about a vertex on the surface. \return how many. O(T log T). */
std::uint64_t
closeGaps(const ProbeField& field, double width, std::vector<Triangle>& triangles,
          SurfaceVertices& vertices);

/** Leaves out components on which fewer points lie than asked for; the largest always stays. O(T). */
void
dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
           std::vector<Triangle>& triangles, MeshStatistics& statistics);

/** Marks as outside the vertices that no leaf supports or that leaves cover less than a fit covers its
 * points: polynomials err there, and trim maps say nothing of where they lead. */
void
markUncovered(const ProbeField& field, double threshold, SurfaceVertices& vertices);

/** Closes small holes of the data, before trimming: patches of vertices that are outside, but do not reach the
 * border of the mesh, and on whose area fewer points would lie than on a disc `hole_size` spacings wide. Their
 * vertices are inside afterwards. \return how many patches. O(T). */
std::uint64_t
closeHoles(const ProbeField& field, double hole_size, const std::vector<Triangle>& triangles,
           SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

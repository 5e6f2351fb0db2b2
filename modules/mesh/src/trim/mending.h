// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/mesh/mesh_extraction.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Closes gaps that contouring has left where the surface continues: border loops of few edges, whose area would
 * contain fewer points than a disc `width` spacings wide, with data on all sides. A gap of three edges gets a
 * triangle, others a fan about a vertex on the surface. \return how many. O(T log T). */
std::uint64_t
closeGaps(const ProbeField& field, double width, std::vector<Triangle>& triangles,
          SurfaceVertices& vertices);

/** Leaves out components with fewer points than requested; the largest is always kept. O(T). */
void
dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
           std::vector<Triangle>& triangles, MeshStatistics& statistics);

/** Marks as outside the vertices that no leaf supports or that leaves cover less than a fit covers its
 * points: polynomials err there, and trim maps do not reach there. */
void
markUncovered(const ProbeField& field, double threshold, SurfaceVertices& vertices);

/** Closes small holes of the data, before trimming: patches of vertices that are outside, but do not reach the
 * border of the mesh, and whose area would contain fewer points than a disc `hole_size` spacings wide. Their
 * vertices are inside afterwards. \return how many patches. O(T). */
std::uint64_t
closeHoles(const ProbeField& field, double hole_size, const std::vector<Triangle>& triangles,
           SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

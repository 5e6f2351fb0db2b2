// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

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

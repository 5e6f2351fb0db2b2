// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** A plane through a place, with a unit normal. */
struct Plane {
  Vector3 place, normal;
};

/** The place nearest to another at which two or three planes meet. \return false: they are nearly
 * parallel. */
bool
meetingOf(const Plane* planes, std::size_t count, const Vector3& near, Vector3& place);

/** Gives a mesh of a rounded surface the sharp edges of another fit to the same points.
 *
 * Each vertex is put onto the nearest face of the sharp surface. An edge of the mesh whose ends are then on
 * faces that part by more than 40 degrees gets a vertex where these faces meet, and a triangle between three
 * faces gets one at their corner, as in Attene, Falcidieno, Rossignac, Spagnuolo: Sharpen&Bend (IEEE TVCG
 * 2005). What is manifold stays so. New vertices have the mean normal of their faces and no curvature.
 * \param[in] sharp oriented, of a fit with FitParams::sharp_features. \param[in,out] vertices in its local
 * units. The same for any number of threads. O(vertices times leaves near each). */
void
sharpen(const SLIMSurface& sharp, int threads, std::vector<Triangle>& triangles,
        SurfaceVertices& vertices, MeshStatistics& statistics);

}  // namespace pcl_slim::detail

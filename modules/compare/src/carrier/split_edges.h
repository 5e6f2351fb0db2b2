// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim::detail {

/** \brief Divides edges above a length at their middles, again and again, until none is longer.
 *
 * Triangles that share an edge share its middle, so that no gap opens. A triangle becomes two, three
 * or four. Vertices keep their order, new ones follow; their normals and standard errors are
 * the mean of both ends'. Colours and curvatures are dropped. O(edges made). \param[in] longest [world units], > 0 */
void splitLongEdges(double longest, TriangleMesh& mesh);

/** \brief Area of all triangles [world units squared]. O(triangles). */
double areaOf(const TriangleMesh& mesh);

}  // namespace pcl_slim::detail

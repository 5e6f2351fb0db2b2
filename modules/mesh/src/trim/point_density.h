// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Points of the data an area [local units] at some vertices: the effective number of points of the leaves
 * there over the area of their balls. 0 where there is no leaf. */
std::vector<double>
densitiesAt(const ProbeField& field, const std::vector<std::uint32_t>& which,
            const SurfaceVertices& vertices);

/** Area of a triangle, local units. */
double
areaOf(const Triangle& triangle, const SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

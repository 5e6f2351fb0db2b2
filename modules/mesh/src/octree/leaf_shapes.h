// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** A leaf of the surface as the octree sees it, local units. */
struct LeafShape {
  std::array<float, 3> center;
  std::array<float, 3> u, v, w;
  float radius;
  float cell_size;  ///< cells on its sheet are to be no wider ...
  float least;      ///< ... unless their halves would be narrower than this
  int degree;
  const float* c;
};

/** A place in the leaf's (u, v) plane and how far the place is from the leaf's sheet. */
struct SheetOffset {
  float u = 0, v = 0;  ///< in radii, brought into the unit disc
  float distance = 0;  ///< signed, local units, to first order
  Vector3 normal{};    ///< of the sheet there, unit
};

SheetOffset
offsetFrom(const LeafShape& leaf, const Vector3& place);

/** The leaves of a surface with the cells' sizes that keep a mesh within a tolerance (local units):
 * sqrt(4 tolerance / k) for the largest curvature k, a Frobenius norm, on the leaf, and at most .6 of its
 * radius; and no less than least_spacings spacings of its points. */
std::vector<LeafShape>
shapesOf(const SLIMSurface& surface, double tolerance, double least_spacings, int threads);

/** The width of a cell such that cells of that width times powers of two, none wider than the leaves on it
 * allow, are as few as possible. O(shapes). */
double
thriftyCellSize(const std::vector<LeafShape>& shapes);

}  // namespace pcl_slim::detail

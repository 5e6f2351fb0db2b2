// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::rivals {

/** \brief Points and unit normals as a method returns them, in the cloud's order; NaN where it
 * drops a point. */
struct Smoothed {
  std::vector<Vector3> points, normals;
};

/** \brief pcl::MovingLeastSquares. \param[in] order of its polynomials \param[in] radius of its
 * search. */
Smoothed smoothByMls(const std::vector<Vector3>& points, int order, double radius);

}  // namespace pcl_slim::rivals

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::rivals {

/** \brief Whether CGAL was found when this was built; without it, no function here may be called.
 */
bool hasJets();

/** \brief An error where they are missing: a table without a rival would look like one in which it
 * is worse.
 * \param[in] option what leaves them out */
Error requireJets(const char* option);

/** \brief CGAL::jet_smooth_point_set of degree 2 over k neighbours. */
std::vector<Vector3> smoothByJets(const std::vector<Vector3>& points, std::size_t k);

/** \brief The surface at a point by CGAL's jets. */
struct Monge {
  Vector3 normal{};       ///< unit, of either sign
  double k1 = 0, k2 = 0;  ///< along the normal; positive where the surface bends towards it
};

/** \brief CGAL::Monge_via_jet_fitting at the first of some points. */
Monge mongeByJets(const std::vector<Vector3>& points, std::size_t degree);

}  // namespace pcl_slim::rivals

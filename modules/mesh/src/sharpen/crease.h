// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** A plane through a place, with a unit normal. */
struct Plane {
  Vector3 place, normal;
};

/** The place nearest to another at which two or three planes meet. \return false: they are nearly
 * parallel. */
bool
meetingOf(const Plane* planes, std::size_t count, const Vector3& near, Vector3& place);

}  // namespace pcl_slim::detail

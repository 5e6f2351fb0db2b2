// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim {

/** \brief What an object passes through as it turns about an axis through the middle of its bulk.
 *
 * A camera that frames it shows all of the bulk from every side. Its origin is on the axis; an
 * empty object is returned as it is. O(spheres).
 * \param[in] axis any length but 0
 */
PCL_SLIM_EXPORT BoundingSpheres sweptAbout(const BoundingSpheres& object,
                                           const std::array<double, 3>& axis);

/** \brief A camera turned by turn / count of a full circle about an axis through a point in world
 * coordinates; to the right where the axis points upwards. Turn 0 is the camera itself. */
PCL_SLIM_EXPORT Camera turnedCamera(const Camera& camera, const std::array<double, 3>& pivot,
                                    const std::array<double, 3>& axis, int turn, int count);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim {

/** \brief Which world axis points upwards in a picture. */
enum class UpAxis : unsigned char { kAuto, kX, kY, kZ };

/** \brief View from an azimuth and an elevation around an upright object.
 *
 * Azimuth 0 is the front: the viewer is at -y when z is up, at +z when y is up, at -y when x
 * is up; positive azimuths turn the viewer to the right. Elevation 90 looks straight down.
 * \param[in] up kAuto counts as kZ; \param[in] azimuth, elevation degrees
 */
PCL_SLIM_EXPORT ViewDirection viewFromAngles(UpAxis up, double azimuth, double elevation);

/** \brief The upward axis an object suggests: z in map coordinates (both horizontal ones beyond 100
 * diagonals), the normal of a flat object if that is y or z, else that of y and z of a room's
 * lesser extent, that along which a closed object stays upright and would fall over along the
 * other, else the one along which it is clearly longer. If neither is, the one along which the
 * normals of an oriented object point upwards on average, because an upright object is not measured
 * from below; else the one at whose lower end the object is flat; else z. Statues are upright,
 * terrain is flat. O(spheres log spheres). */
PCL_SLIM_EXPORT UpAxis guessUpAxis(const BoundingSpheres& object);

/** \brief A pleasant view of a whole object. O(spheres log spheres).
 *
 * - A cloud seen by a depth camera at the world's origin (x right, y down, z forward) is shown
 *   from there.
 * - Terrain, a flat cloud or one with map coordinates, is shown obliquely from above, across its
 *   longer side if it has one.
 * - The inside of a room is looked down into from above.
 * - A one-sided scan is shown from the side its normals face (oriented objects only); when that
 *   is -z, in the axes of a camera (x right, y down, z forward).
 * - Anything else is shown from the front, turned by 30 degrees and slightly from above.
 */
PCL_SLIM_EXPORT ViewDirection chooseView(const BoundingSpheres& object, UpAxis up = UpAxis::kAuto);

/** \brief Whether an object surrounds the place that it was seen from, as the scan of a room does:
 * its near side, drawn, hides the rest. O(spheres). */
PCL_SLIM_EXPORT bool isSeenFromInside(const BoundingSpheres& object);

/** \brief The world direction that is upwards in the view of chooseView, however far that looks
 * down: the upward axis, or -y for what is shown in the axes of a camera. O(spheres log spheres).
 */
PCL_SLIM_EXPORT std::array<double, 3> upwardsIn(const BoundingSpheres& object,
                                                UpAxis up = UpAxis::kAuto);

}  // namespace pcl_slim

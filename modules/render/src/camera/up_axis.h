// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "camera/sphere_cloud.h"

namespace pcl_slim::detail {

/** \brief How an object was seen, which decides how it is shown. */
enum class SceneKind {
  kObject,   ///< from all sides or most
  kGround,   ///< from above: terrain with what is on it
  kOneSide,  ///< from one side
  kCamera,   ///< by a camera at the world's origin
  kInside,   ///< from inside, closed round about: a room
  kStation   ///< from inside, open above: what surrounds a scanner
};

/** \brief An object's upward direction and kind. */
struct Upright {
  SignedAxis up;
  SceneKind kind = SceneKind::kObject;
  Vantage vantage;
};

/** \brief \param[in] given the upward direction, if the user gave one; null: to be found. O(spheres
 * log spheres). */
Upright findUpright(const SphereCloud& cloud, const BoundingSpheres& object,
                    const SignedAxis* given);

}  // namespace pcl_slim::detail

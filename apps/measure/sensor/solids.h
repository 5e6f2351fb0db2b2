// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/vector3.h"

/** \brief Exact surfaces that sensors look at: a ray meets them, and any point has a foot on them.
 * Metres. */
namespace pcl_slim::measure {

/** \brief One surface of a scene. */
struct Solid {
  enum class Kind {
    kPlane,  ///< through center, across axis
    kWaves,  ///< a plane with waves along its first tangent
    kSphere,
    kPole  ///< a cylinder without ends about center, along z
  };
  Kind kind = Kind::kPlane;
  Vector3 center{}, axis{{0, 0, 1}};                       ///< axis: unit
  double radius = 0;                                       ///< of a sphere or pole
  double amplitude = 0, wavelength = 0;                    ///< of waves
  Vector3 low{{-1e9, -1e9, -1e9}}, high{{1e9, 1e9, 1e9}};  ///< the solid ends at this box
};

/** \brief The distance along a ray from origin at which it meets a solid; infinite if it does not.
 * \param[in] direction of any length; the distance is in units of it. */
double
meet(const Solid& solid, const Vector3& origin, const Vector3& direction);

/** \brief Signed distance of a point from a solid, and the solid's unit normal at its foot. */
struct Foot {
  double distance = 0;
  Vector3 normal{};
};

Foot
footOn(const Solid& solid, const Vector3& point);

}  // namespace pcl_slim::measure

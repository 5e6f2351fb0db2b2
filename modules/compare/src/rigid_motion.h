// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/compare/registration.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief A rotation about a place by the length of a vector [rad] along it (Rodrigues), then a
 * translation. */
RigidMotion rigidMotion(const Vector3& translation, const Vector3& rotation, const Vector3& center);

/** \brief The motion that is first and then after, about the centre of first. */
RigidMotion composed(const RigidMotion& after, const RigidMotion& first);

/** \brief Axis times angle of a motion's rotation, angle in [0, pi]. */
Vector3 rotationVector(const RigidMotion& motion);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/compare/place_columns.h"
#include "pcl_slim/compare/registration.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief How an object is turned and moved before it is compared with its reference. */
struct PCL_SLIM_EXPORT AlignmentParams {
  RegistrationParams registration;
  bool apply = false;  ///< move the places by the motion that remains
};

/** \brief How some places and their reference are placed to each other. */
struct PCL_SLIM_EXPORT Alignment {
  bool turned = false;        ///< the places' normals face the other way than the reference's
  Registration registration;  ///< what motion remains; none where it is unknown
  Error unknown;              ///< why no motion could be estimated, or no error
  RigidMotion motion;         ///< that is applied: registration.motion, or none

  /** \brief The places as the reference has them: normals turned, positions moved. O(places). */
  PlaceColumns forward(const PlaceColumns& places, int threads = 0) const;
  /** \brief Places of the reference as the other object has them. O(places). */
  PlaceColumns backward(const PlaceColumns& places, int threads = 0) const;
};

/** \brief Finds out whether normals have to be turned (facesAway()), and estimates the motion that
 * remains (registerPlaces()) from up to 20,000 places. \param[in] places before any motion
 * \return an error for bad parameters or cancellation, and where a motion is to be applied that
 * cannot be estimated. */
PCL_SLIM_EXPORT Result<Alignment> alignmentOf(const DeviationReference& reference,
                                              const PlaceColumns& places,
                                              const AlignmentParams& params,
                                              Progress* progress = nullptr);

/** \brief The motion back. */
PCL_SLIM_EXPORT RigidMotion inverseOf(const RigidMotion& motion);

}  // namespace pcl_slim

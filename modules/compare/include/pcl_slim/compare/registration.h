// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

/** \brief A rigid motion of space: x -> rotation (x - center) + center + translation. */
struct PCL_SLIM_EXPORT RigidMotion {
  std::array<Vector3, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows
  Vector3 center{}, translation{};

  /** \brief Where a place goes. */
  Vector3 place(const Vector3& p) const;
  /** \brief Where a direction turns. */
  Vector3 direction(const Vector3& d) const;
  /** \brief The same as a 4 x 4 matrix, row by row, for column vectors (x, y, z, 1). */
  std::array<double, 16> matrix() const;
};

/** \brief How a remaining motion is estimated. */
struct PCL_SLIM_EXPORT RegistrationParams {
  FootParams feet;
  std::size_t most_places = 100000;  ///< more are thinned evenly along their Morton order
  int most_iterations = 50;
  /// number of places with independent errors, of those given; 0: all are independent
  double effective_count = 0;
  /// RMS change of distance [lengths moved] below which a motion does not change the fit, so that it
  /// is undetermined
  double least_slope = 0.02;

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief One of six motions that are estimated independently of each other: an eigenvector of the
 * normal equations. Rotations are about the centroid. */
struct RegistrationMode {
  Vector3 translation{};  ///< of a unit of the mode, world units
  Vector3 rotation{};     ///< likewise [rad]
  double slope = 0;       ///< RMS change of distance of a unit of the mode, in [0, about 1]
  double value = 0;       ///< estimated, in units of the mode (world units of length)
  double error = 0;       ///< its standard error; infinite where undetermined
  bool determined = false;
};

/** \brief The motion that takes places onto their reference, with standard errors. */
struct Registration {
  RigidMotion motion;     ///< about the centroid of the places; apply it to the places
  Vector3 translation{};  ///< of the centroid, world units
  Vector3 rotation{};     ///< axis times angle about the centroid [rad]
  Vector3 translation_error{}, rotation_error{};  ///< standard errors; infinite where undetermined
  std::array<RegistrationMode, 6> modes;          ///< best determined first
  int rank = 0;             ///< modes that are determined; the others are not applied
  std::size_t places = 0;   ///< that had a counterpart at the end
  std::size_t inliers = 0;  ///< of these, with a weight above 1/2
  double noise = 0;         ///< 1.4826 MAD of the distances at the end
  double rms_before = 0;    ///< weighted RMS of the distances of inliers, before the motion
  double rms_after = 0;     ///< and after it
  int iterations = 0;
  bool converged = false;

  /** \brief Standard error of the motion's displacement along a direction at a place. */
  PCL_SLIM_EXPORT double errorAt(const Vector3& place, const Vector3& direction) const;
  /** \brief Covariance of the six numbers, translation first, of the determined modes. */
  std::array<std::array<double, 6>, 6> covariance{};
};

/** \brief Estimates what motion remains between places and a reference: point-to-plane ICP (Chen and
 * Medioni, Object modelling by registration of multiple range images, 1992) with feet on the
 * reference, first with Huber's weights, then with Tukey's, both by the median absolute deviation of
 * the residuals. Tukey's weights are 0 beyond 4.685 deviations, so that a change of a part of the
 * object has no influence.
 *
 * Each place weighs by its robust weight alone. Standard errors are those of an M-estimator (Huber,
 * Robust Statistics, 1981, section 7.6) times the square root of places per independent place.
 * Directions in which the object can slide along itself (Gelfand et al., Geometrically stable
 * sampling for the ICP algorithm, 2003) are undetermined and not applied: three of a plane or a
 * sphere, two of a cylinder, one of a torus. Places whose foot is on a border do not count.
 * \return an error for bad parameters, fewer than 6 places with a counterpart, or cancellation.
 * O(iterations times the time of DeviationReference::find()); same for any number of threads. */
PCL_SLIM_EXPORT Result<Registration> registerPlaces(const DeviationReference& reference,
                                                    const DeviationPlaces& places,
                                                    const RegistrationParams& params,
                                                    Progress* progress = nullptr);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/compare/registration.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Places to compare with a reference, in world coordinates: what DeviationPlaces borrows. */
struct PCL_SLIM_EXPORT PlaceColumns {
  std::vector<Vector3> positions;
  std::vector<std::array<float, 3>> normals;  ///< unit, zero where unknown; empty: none are known
  std::vector<float> sigma;  ///< standard errors along the normal [world units]; empty: exact
  bool oriented = false;     ///< the normals point to one side consistently

  std::size_t size() const { return positions.size(); }
  /** \brief A view, valid while this object lives and is not changed. */
  DeviationPlaces view() const;
  /** \brief Applies a motion to positions and normals. O(places). */
  void move(const RigidMotion& motion, int threads = 0);
  /** \brief Turns all normals to the other side. O(places). */
  void turn();
};

/** \brief What the points of a scan are compared at. */
enum class ScanPlaces : unsigned char {
  kMoved,     ///< where the scan's surface is: noise is averaged
  kMeasured,  ///< as measured, with the scan's noise as their error
};

/** \brief The places of a scan's points, one for each point that the view selects.
 *
 * Points that no surfel supports have their measured place, the scan's noise as their error, and no
 * normal; points that are not finite stay so.
 * \param[in] projection of the same view onto the same surface, for kMoved with
 * ProjectionParams::errors. O(points); the same for any number
 * of threads. */
PCL_SLIM_EXPORT PlaceColumns placesOf(const CloudView& cloud, const CloudProjection& projection,
                                      const SLIMSurface& surface, ScanPlaces which,
                                      int threads = 0);

/** \brief Standard deviation of the noise that a surface was fitted to [world units]. */
PCL_SLIM_EXPORT double noiseOf(const SLIMSurface& surface);

/** \brief Number of a scan's places whose errors are independent: those of a leaf share its error,
 * and measured points as many as SurfaceInfo::correlation says. O(surfels). */
PCL_SLIM_EXPORT double independentPlaces(const SLIMSurface& surface, ScanPlaces which);

/** \brief Whether most places face away from the reference at their nearest place: the sides of one
 * of the two are then the other's turned round, as those of open scans may be. False where either
 * is not oriented, or nothing is near.
 *
 * Looks at the places that facingShare() chooses. \return its error. */
PCL_SLIM_EXPORT Result<bool> facesAway(const DeviationReference& reference,
                                       const PlaceColumns& places, const FootParams& params);

}  // namespace pcl_slim

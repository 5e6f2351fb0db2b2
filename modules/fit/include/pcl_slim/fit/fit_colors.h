// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Gives every surfel of a surface the colour of the points in its ball: a polynomial over
 * its (u, v) plane (surfel_color.h), fitted by least squares with the blend's weights to the points
 * near its own polynomial.
 *
 * \param[in] store the points that the surface was fitted to \param[in] cloud what the store was
 * built of
 * \param[in] colors one for each point of the cloud; without any the surface gets none
 * \return an error where surface and store differ in their units. O(points in the balls), at most
 * 4096 of a ball; the same for any number of threads. */
PCL_SLIM_EXPORT Error fitColors(const PointStore& store, const CloudView& cloud,
                                const ColorView& colors, int threads, SLIMSurface& surface);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit/accuracy.h"
#include "pcl_slim/fit/fit.h"
#include "support/lab/sensor.h"

namespace pcl_slim::measure {

/** \brief RMS errors of a smoothed scan. */
struct SensorErrors {
  double position = 0;                     ///< [mm], every point but mixed pixels
  double normal = 0;                       ///< [degrees], regardless of sign
  std::vector<double> positions, normals;  ///< the same, solid by solid
  double unit = 0;                         ///< L of a fit [mm]
};

/** \brief Leaves points nearer than this to another solid out of all errors. Beside a crease no
 * smoother can decide the side of a point, and most of the squared error is there. */
void leaveOutCreases(double distance, SensorScan& scan);

/** \brief Errors of places and normals that a method gives for the points of a scan. Places that are
 * not finite are left out, normals that are not finite are not counted. */
SensorErrors errorsOf(const SensorScan& scan, const std::vector<Vector3>& places,
                      const std::vector<Vector3>& normals);

/** \brief A scan by our fit and projection; what no leaf supports keeps its place.
 * \param[in] fitter fits the surface; fitSurface() if empty */
Result<SensorErrors> errorsOfFit(const SensorScan& scan, const FitParams& params,
                                 FitStatistics& statistics, const Fitter& fitter = {});

/** \brief A scan by pcl::MovingLeastSquares of order 2; points that it drops are left out. */
SensorErrors errorsOfMls(const SensorScan& scan, double radius);

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim::measure {

/** \brief Points after fit and projection, in the cloud's order and world units. */
struct SmoothedPoints {
  std::vector<Vector3>
      points;  ///< a point that is not stored is NaN; an unsupported one is unchanged
  std::vector<Vector3> normals;                ///< unit; zero where unsupported
  std::vector<double> mean, gaussian, k1, k2;  ///< where the projection computes them
  std::vector<Vector3> leaves;                 ///< centres
  FitStatistics fit;
  double sigma = 0;    ///< noise found
  double seconds = 0;  ///< CPU time of store, fit and projection
};

/** \brief Fits a cloud and projects its points. */
Result<SmoothedPoints> smoothPoints(const CloudView& cloud, const FitParams& fit,
                                    ProjectionParams projection = {});

/** \brief A view of points; valid while they are. */
CloudView viewOf(const std::vector<Vector3>& points);

}  // namespace pcl_slim::measure

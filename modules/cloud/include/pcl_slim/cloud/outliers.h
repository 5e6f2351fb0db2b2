// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief The outliers of a cloud: points that are far from every surface and line.
 *
 * A point is one if its eight nearest neighbours are 3 times as far away as those of the cloud's
 * median point, and it is no part of a sparse surface or line: its 16 neighbours fill a volume (the
 * least eigenvalue of their covariance exceeds .1 of the greatest), or most of them are a far
 * denser patch, off whose plane it is, or half of them are outliers. Where more than .5 % of the
 * 4,096 points about are outliers, points closer to the surface are examined, too: those whose
 * neighbours are 1.5 times as far away as the median, and which are 4 times as far off the plane of
 * 24 neighbours as these do themselves (RMS), neighbours that are outliers left out; this is done
 * again where it found more than .1 %, as one hides another.
 *
 * No decision depends on the axes, the order of the points or the unit of length.
 * \return stored points, ascending; none in clouds of fewer than 100 points. Same result for any
 * number of threads. A few nanoseconds a point, and a few microseconds for each point far from
 * others.
 * \param[in] spacing how far the eighth neighbour of the median point is, local units, as of a
 * cloud of which this is a part; 0: measured here
 */
PCL_SLIM_EXPORT std::vector<std::uint32_t> findOutliers(const PointStore& store, int threads = 0,
                                                        double spacing = 0.0);

/** \brief Distance to the eighth neighbour of a cloud's median point, local units, from 256 of its
 * points. */
PCL_SLIM_EXPORT double medianSpacing(const PointStore& store);

}  // namespace pcl_slim

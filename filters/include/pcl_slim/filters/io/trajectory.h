// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief Where a sensor was, over time. */
struct Trajectory {
  std::vector<double> time;  ///< ascending, no two alike
  std::vector<std::array<double, 3>> place;
};

/** \brief Reads a trajectory from text, one place a line; lines that start with # are comments.
 *
 * Without names: t x y z, or TUM's t x y z qx qy qz qw. With a line of names, as CSV has it: the
 * time is t, time, timestamp, stamp, gps_time or gpstime; the place x y z, tx ty tz, px py pz,
 * pos_x pos_y pos_z, position_x ..., or easting northing height (elevation, altitude); names in any
 * case, with units in brackets. Other columns are ignored. Lines may come in any order. \return an
 * error for a file that cannot be read, fewer than two times, a value that is no number, or two
 * places at one time. */
PCL_SLIM_EXPORT Result<Trajectory> loadTrajectory(const std::string& path);

/** \brief Where each point of a file was seen from: places of the trajectory, linearly interpolated
 * at the point's time.
 *
 * \param[in] time_field the field that has the points' times; empty: the one field that is named as
 * a trajectory's time may be \param[in] offset added to the points' times
 * \return x y z of each point, NaN for points with a coordinate that is not finite; an error for a
 * missing or ambiguous field, for times outside the trajectory, and for a field of floats too
 * coarse for it. O(points log places). */
PCL_SLIM_EXPORT Result<std::vector<double>> sensorPlaces(const Trajectory& trajectory,
                                                         const PointFile& file,
                                                         const std::string& time_field = "",
                                                         double offset = 0.0);

}  // namespace pcl_slim

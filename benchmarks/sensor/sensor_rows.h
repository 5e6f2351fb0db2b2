// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/lab/sensor.h"

namespace pcl_slim::measure {

/** \brief A row of the table: one scan, and the radii that MLS is given for it. */
struct SensorRow {
  std::string name;
  std::function<SensorScan(std::uint64_t seed)> scan;
  std::vector<double> radii;  ///< [m]
};

/** \brief Every row whose name contains a text. */
std::vector<SensorRow> sensorRows(const std::string& part);

}  // namespace pcl_slim::measure

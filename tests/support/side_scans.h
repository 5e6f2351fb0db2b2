// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/clouds.h"
#include "support/lab/sensor.h"

/** \brief Scans from known places, and bodies that were not scanned from one. */
namespace pcl_slim_test {

using pcl_slim::measure::SensorScan;
using pcl_slim::measure::Solid;

/** A scan's points about the place that they were seen from. */
inline Cloud aboutSensor(const SensorScan& scan) {
  Cloud cloud;
  for (std::size_t i = 0; i < scan.points.size(); i += 3) {
    cloud.add(scan.points[i] - scan.sensor[0], scan.points[i + 1] - scan.sensor[1],
              scan.points[i + 2] - scan.sensor[2]);
  }
  return cloud;
}

/** The walls, floor and ceiling of a box about the origin; they face inwards. */
inline std::vector<Solid> roomOfWalls(const pcl_slim::Vector3& half) {
  std::vector<Solid> walls;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double way : {1.0, -1.0}) {
      Solid wall;
      wall.axis = {};
      wall.axis[axis] = -way;
      wall.center[axis] = way * half[axis];
      for (std::size_t a = 0; a < 3; ++a) {
        wall.low[a] = -half[a] - 1e-6;
        wall.high[a] = half[a] + 1e-6;
      }
      walls.push_back(wall);
    }
  }
  return walls;
}

/** A room of 8 x 6 x 3 m as a turning lidar at the origin sees it, noise 5 mm. */
inline Cloud scannedRoom(int rings = 60, int steps = 400) {
  pcl_slim::measure::TurningLidar lidar;
  lidar.origin = {};
  lidar.rings = rings;
  lidar.steps = steps;
  lidar.lowest = -60;
  lidar.highest = 60;
  lidar.sigma = 0.005;
  return aboutSensor(scanByLidar(roomOfWalls({4, 3, 1.5}), lidar, 3));
}

}  // namespace pcl_slim_test

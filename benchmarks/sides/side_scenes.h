// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/vector3.h"

/** \brief Generated scans whose sides are known: rooms, streets, turntables, terrain, CAD bodies. */
namespace pcl_slim::sides {

/** \brief A generated scan with the truth about its sides. Metres. */
struct SideScene {
  std::string name;
  std::vector<Vector3> points;
  std::vector<Vector3> sensors;  ///< where points were seen from: one place, or one for each point
  /// true, unit: outward, up, or facing the sensor; zero: the side of this point is not judged;
  /// empty: there is no truth
  std::vector<Vector3> normals;
  std::vector<std::array<float, 3>> given_normals;  ///< given to the library; empty: none
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< blue green red, or empty
  bool closed = false;                              ///< normals are outward, of a whole body
  bool sensor_known = false;                        ///< the library is given the sensor ...
  bool viewpoint_known = false;                     ///< ... as FitParams::viewpoint
  bool scanned_from_origin = false;  ///< the only sensor is at 0; the library is not given it

  /** \brief A view with what the library is given, valid while the scene is. */
  CloudView view() const;
  ColorView colorView() const;
};

/** \brief A scene that is made when it is needed. */
struct SceneMaker {
  std::string name;
  std::function<SideScene()> make;
};

/** \brief All scenes, fixed by seed. */
std::vector<SceneMaker> sceneMakers(std::uint64_t seed);

}  // namespace pcl_slim::sides

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "sides/side_scenes.h"

/** \brief Generated scans whose upward direction is known, in the axes that programs use. */
namespace pcl_slim::views {

/** \brief What a viewer has to see of a scan. */
enum class Kind {
  kObject,   ///< an object from any side
  kOneSide,  ///< the side that was scanned
  kGround,   ///< terrain, from above
  kInside,   ///< a room without its near side
  kStation   ///< what surrounds a scanner, from a place that it saw
};

/** \brief A scan and the truth about its view. */
struct ViewScene {
  sides::SideScene scan;
  Vector3 up{{0, 0, 1}};
  Kind kind = Kind::kObject;
};

/** \brief A scene that is made when it is needed. */
struct SceneMaker {
  std::string name;
  std::function<ViewScene()> make;
};

/** \brief All scenes, fixed by seed; most of them with z up, with y up, and some with one of these
 * down. */
std::vector<SceneMaker> sceneMakers(std::uint64_t seed);

}  // namespace pcl_slim::views

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>

#include "continuity/continuity_scan.h"

namespace pcl_slim::continuity {

/** \brief A scan changed in a way that should change no result. */
struct Varied {
  Points points;
  std::vector<std::size_t>
      source;  ///< of each point: its point in the scan; beyond source.size(), none
  PointOrigins origins;
  std::optional<Eigen::Vector3d> sensor;  ///< of all points, where the scan itself does not have it
  bool floats = true;
  Eigen::Affine3d map = Eigen::Affine3d::Identity();  ///< from the scan to here: a similarity
  double scale = 1;                                   ///< of the map
  double density = 1;                                 ///< points an area, of the scan's
  std::array<double, 2> sigma{1, 1};  ///< to be found, relative to the scan's: from, to
  double leaves = 0;                  ///< of the scan that this part has
};

/** \brief A named change; it yields no points where the scan has nothing to change. */
struct Variant {
  std::string name;
  std::function<Varied(const Scan& scan, const measure::SmoothedPoints& smoothed)> make;
};

/** \brief Turns, moves and scales, other precision, fewer points, parts, and merged frames. */
std::vector<Variant> allVariants(std::uint64_t seed);

}  // namespace pcl_slim::continuity

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "fit/smoothed_points.h"

namespace pcl_slim::continuity {

using Points = std::vector<Eigen::Vector3d>;

/** \brief A scan whose variants are compared: its finite points. */
struct Scan {
  std::string name;
  Points points;
  std::vector<std::uint32_t> row, column;  ///< of each point in an organized cloud; else empty
  bool floats = true;                      ///< coordinates have float precision
  std::optional<Eigen::Vector3d> sensor;
  std::optional<Eigen::Vector3d> camera;  ///< of a generated scan, which fits are not given
  Points second;  ///< another frame of the same scene with errors of its own; empty: there is none

  Eigen::AlignedBox3d box() const;
};

/** \brief Loads a .pcd or .ply file. */
Result<Scan> loadScan(const std::string& path);

/** \brief Generated scans of sensor_bench whose names contain a text, of one seed. */
std::vector<Scan> generatedScans(const std::string& part, std::uint64_t seed);

/** \brief Keeps at most this many points: a window about the middle of an organized cloud, whose
 * errors keep their correlation; a random subset of any other. */
void reduce(std::size_t most, std::uint64_t seed, Scan& scan);

/** \brief Where each point is from. */
struct PointOrigins {
  Points sensors;                     ///< of each point; empty: not known
  std::vector<std::uint32_t> frames;  ///< likewise
};

/** \brief Fits points and projects them; rounds them to float first where asked for.
 * \param[in] sensor of all points, or none */
Result<measure::SmoothedPoints> smooth(const Points& points, bool floats,
                                       const std::optional<Eigen::Vector3d>& sensor,
                                       const PointOrigins& origins, const FitParams& params);

}  // namespace pcl_slim::continuity

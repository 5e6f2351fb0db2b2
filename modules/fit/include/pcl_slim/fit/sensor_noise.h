// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief The noise of a sensor, measured on one frame and used for the next ones
 * (docs/noise.md, "A sensor's next frame"). Lengths are in the unit of the frames.
 *
 * A fit with FitParams::keep_sensor_noise measures it, NoiseStatistics::sensor_noise returns it, and
 * a fit with FitParams::sensor_noise uses it: there a check of a few hundred patches replaces the
 * measurement of the noise, unless the frame's residuals differ from it. */
struct PCL_SLIM_EXPORT SensorNoise {
  /// a, b, c: RMS error a + b z + c z^2 along the ray at distance z from the sensor; where
  /// along_rays is false, a alone is the RMS error across the surface
  std::array<double, 3> error{};
  bool along_rays = false;       ///< the sensor's position was known
  double relative_error = 0;     ///< standard error of the RMS error, as a share of it
  double correlation = 1;        ///< points that share an error; 1: white noise
  double correlation_error = 0;  ///< relative standard error of that number
  double dependence = 1;         ///< points that a fit counts as one; less than a large correlation
  double step = 0;               ///< of quantised coordinates; 0: none
  std::uint64_t line = 0;        ///< points along a scan line that count as one; 0: no lines
  std::uint64_t neighbors = 0;   ///< points of a patch that shows all of the noise
  /// RMS residual of cubics on patches of 40 and 320 points, as a share of the RMS error across the
  /// surface there: below 1 where a patch follows shared errors
  std::array<double, 2> residual{};
  std::array<double, 2> residual_error{};  ///< standard errors of these
  std::uint32_t columns = 0, rows = 0;     ///< pixels of an organised frame; 0: not organised

  /** \brief Names the first member out of range. */
  Error validate() const;

  /** \brief Whether frames of this many columns and rows are of such a sensor; unorganised clouds
   * have 1 row or 0. */
  bool hasSize(std::uint32_t frame_columns, std::uint32_t frame_rows) const {
    const bool organised = frame_rows > 1;
    return organised ? columns == frame_columns && rows == frame_rows : rows == 0;
  }
};

/** \brief Whether all members are equal. */
PCL_SLIM_EXPORT bool operator==(const SensorNoise& a, const SensorNoise& b);
/** \brief Whether a member differs. */
inline bool operator!=(const SensorNoise& a, const SensorNoise& b) {
  return !(a == b);
}

/** \brief A sensor's noise as a JSON object; numbers are exact (17 digits). */
PCL_SLIM_EXPORT std::string toJson(const SensorNoise& noise);

/** \brief Reads what toJson() wrote. \param[in] name of the source, for messages
 * \return kBadInput for a text that is no JSON object of a sensor's noise, lacks a member, has a
 * member of another type or out of range. Members with other names are ignored. */
PCL_SLIM_EXPORT Result<SensorNoise> sensorNoiseFromJson(const std::string& text,
                                                        const std::string& name);

/** \brief Writes toJson() to a file, as writeFile() does. */
PCL_SLIM_EXPORT Error saveSensorNoise(const std::string& path, const SensorNoise& noise);

/** \brief Reads a file of saveSensorNoise(). */
PCL_SLIM_EXPORT Result<SensorNoise> loadSensorNoise(const std::string& path);

}  // namespace pcl_slim

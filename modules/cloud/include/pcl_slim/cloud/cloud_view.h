// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Points owned by someone else, as strided arrays; nothing is copied.
 *
 * Coordinates are three consecutive floats or three consecutive doubles per point, and so are the
 * places of sensors, when present; normals are three consecutive floats. A point whose coordinates
 * are not finite is skipped; a normal that is zero or not finite counts as missing for that point.
 */
struct PCL_SLIM_EXPORT CloudView {
  /** \brief The type of coordinates. */
  enum class Scalar : unsigned char { kFloat, kDouble };

  const void* xyz = nullptr;   ///< address of the first point's x
  std::size_t xyz_stride = 0;  ///< bytes from one point to the next
  Scalar scalar = Scalar::kFloat;
  const void* normal = nullptr;           ///< address of the first normal's x, or null
  std::size_t normal_stride = 0;          ///< bytes from one normal to the next
  std::size_t size = 0;                   ///< number of points behind xyz and normal
  const std::int32_t* indices = nullptr;  ///< points to use (null: all), values in [0, size)
  std::size_t num_indices = 0;
  std::optional<std::array<double, 3>>
      sensor;  ///< where the points were seen from, if that is known
  const void* sensors =
      nullptr;  ///< where each was seen from: address of the first one's x, or null
  std::size_t sensors_stride = 0;  ///< bytes from one such place to the next
  Scalar sensors_scalar = Scalar::kDouble;
  const std::uint32_t* frame_numbers =
      nullptr;  ///< which of several merged frames each point is from, or null

  /** \brief Number of points to use. */
  std::size_t count() const { return indices ? num_indices : size; }
  /** \brief Input index of the i-th point to use. */
  std::size_t inputIndex(std::size_t i) const {
    return indices ? static_cast<std::size_t>(indices[i]) : i;
  }

  /** \brief A point's coordinates, by its index in the cloud. */
  std::array<double, 3> position(std::size_t input) const {
    return placeAt(xyz, input * xyz_stride, scalar);
  }
  /** \brief A point's normal as it is given, of any length, by its index in the cloud; needs
   * normals. */
  std::array<float, 3> givenNormal(std::size_t input) const;
  /** \brief Where a point was seen from, by its index in the cloud; needs sensors. */
  std::array<double, 3> sensorPosition(std::size_t input) const {
    return placeAt(sensors, input * sensors_stride, sensors_scalar);
  }

  /** \brief Why there is nothing to work on: no points, more than 2^32 - 2, or an index outside.
   * O(indices). */
  Error validate() const;
  /** \brief The error message for a cloud whose points all are NaN or infinite. */
  static Error nothingFinite();

 private:
  static std::array<double, 3> placeAt(const void* first, std::size_t offset, Scalar scalar);
};

/** \brief Colours owned by someone else: three consecutive bytes blue, green, red per point, as PCL
 * keeps them; as many points as the CloudView has. */
struct ColorView {
  const void* bgr = nullptr;  ///< address of the first point's blue, or null: no colours
  std::size_t stride = 0;     ///< bytes from one point to the next
};

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

/** \brief Where a cloud's normals come from. */
enum class NormalSource { kNothing, kFields, kMesh, kEstimated };

/** \brief What the modules read of a table's fields: coordinates, normals, sensors and colours.
 *
 * Coordinates are read in the table's own precision, without a copy where their layout is one of
 * CloudView's own; other types become doubles. Normals come from the fields normal_x normal_y
 * normal_z, unless all of them are zero or not finite. The places that points were seen from come
 * from the fields vp_x vp_y vp_z, unless all of them are zero. Colours come from the field rgba or
 * rgb of four bytes, else from blue green red or b g r of any type: their white is 1 for fractions up
 * to that, 255 for values up to that, 65535 up to that, else the largest.
 */
struct PCL_SLIM_EXPORT ScanColumns {
  std::vector<double> xyz;            ///< coordinates, where they could not be used in place
  std::vector<float> normals;         ///< normals, likewise, and those made elsewhere
  std::vector<double> sensors;        ///< x y z that each point was seen from, or none
  std::vector<std::uint32_t> frames;  ///< which of several merged frames each is from, or none
  std::vector<std::uint8_t>
      colors;  ///< blue green red of each point, where no field has them packed
  NormalSource normal_source = NormalSource::kNothing;
  bool double_precision = false;
  std::uint64_t num_non_finite = 0;  ///< points with a NaN or infinite coordinate

  /** \brief Reads the fields of a consistent table (checkPointTable). \return an error for one
   * without the fields x y z. O(points). */
  static Result<ScanColumns> of(const PointTable& points);

  /** \brief A view of the points, which are those that the columns were read from; valid while both
   * live and are not changed. */
  CloudView viewOf(const PointTable& points, bool with_normals = true) const;

  /** \brief Their colours; null without. Valid likewise. */
  ColorView colorViewOf(const PointTable& points) const;
};

/** \brief Points in a table, as the modules work on them. */
struct PCL_SLIM_EXPORT ScanTable {
  PointTable points;
  ScanColumns columns;
  /// where the points were seen from, if that is known and no field has it
  std::optional<std::array<double, 3>> sensor;

  /** \brief Takes points. \return an error for a table that contradicts itself (checkPointTable) or
   * has no fields x y z; one without points is none. O(points). */
  static Result<ScanTable> from(PointTable points);

  std::size_t size() const { return numPoints(points); }
  /** \brief Whether some point has finite coordinates. */
  bool hasFinite() const { return columns.num_non_finite < size(); }

  /** \brief A view of the points; valid while this object lives and is not changed. */
  CloudView view(bool with_normals = true) const;
  /** \brief Their colours; null without. Valid likewise. */
  ColorView colors() const { return columns.colorViewOf(points); }
};

}  // namespace pcl_slim

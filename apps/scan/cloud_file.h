// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/scan_table.h"
#include "pcl_slim/filters/io/table_fields.h"
#include "scan/input_options.h"

namespace pcl_slim {

/** \brief A scan as a program works on it: the file with all its fields, and a view of its points.
 *
 * What ScanColumns reads of the fields; without normals there, those of a mesh come from its faces,
 * weighted by area; vertices no face names then have none. A closed mesh whose faces face inwards is
 * turned outwards.
 */
struct CloudFile : ScanColumns {
  PointFile file;
  bool turned_outwards = false;  ///< the faces are a closed mesh's, which faced inwards in the file

  std::size_t size() const { return numPoints(file.cloud); }

  /** \brief Where the file's sensor was; 0 where the file gives no finite place. */
  std::array<double, 3> sensor() const;

  /** \brief A view of the points; valid while this object lives and is not changed. */
  CloudView view(bool with_normals = true) const;
};

/** \brief Loads a file of any format of loadPointFile(). A missing, foreign, truncated or
 * coordinate-less file gives an error; one without points does not. */
Result<CloudFile> loadCloudFile(const std::string& path);

/** \brief A cloud of points that are read already. \param[in] name what an error calls them. */
Result<CloudFile> asCloudFile(PointFile file, const std::string& name);

/** \brief The colours of a cloud's points; null without. Valid as long as view() is. */
ColorView colorsOf(const CloudFile& cloud);

/** \brief Replaces the normals by PCL's, from the k nearest neighbours of each point.
 *
 * They point to the viewpoint (world coordinates; none: the points' sensors, or the file's).
 * \param[in] threads 0: all cores. \return an error for a k beyond the number of finite points.
 */
Error estimateNormals(int k, const std::optional<std::array<double, 3>>& viewpoint, int threads,
                      CloudFile& cloud);

/** \brief Appends the points of further registered frames to those of a first one.
 *
 * The points become one row, in the order of the files; the fields vp_x vp_y vp_z have the place
 * that each was seen from: a frame's own fields of these names or, where they are missing or 0, its
 * VIEWPOINT. The field frame has the frames' numbers, from 0 on, unless the frames have a field of
 * that name. \return an error for a frame that cannot be read, has other fields than the first, or
 * has faces. O(points).
 * \param[in] name of the first frame's file, for messages. \param[in] others further files, read as
 * input says
 * \param[out] numbers of the frame of each point
 */
Error mergeFrames(const std::string& name, const std::vector<std::string>& others,
                  const InputOptions& input, PointFile& first, std::vector<std::uint32_t>& numbers);

/** \brief Numbers the frames of a cloud by the values of a field, in ascending order.
 * \return an error where there is no such field or one of its values is not finite. O(points log
 * frames). */
Error framesByField(const PointTable& cloud, const std::string& field,
                    std::vector<std::uint32_t>& numbers);

/** \brief The file with other points: its sensor, comments, faces and records of LAS. */
PointFile withPoints(const PointFile& file, PointTable points);

/** \brief A copy of a point file in which these fields can be written as real numbers. */
PointFile withRealFields(const PointFile& file, const std::vector<std::string>& names,
                         std::uint8_t type);

}  // namespace pcl_slim

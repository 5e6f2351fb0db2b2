// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief Appends the points of further registered frames to those of a first one.
 *
 * The points become one row, in the order of the files; the fields vp_x vp_y vp_z have the place that each was seen
 * from: a frame's own fields of these names or, where they are missing or 0, its VIEWPOINT. The field frame has the
 * frames' numbers, from 0 on, unless the frames have a field of that name. \return an error for a frame that cannot be
 * read, has other fields than the first, or has faces. O(points).
 * \param[in] name of the first frame's file, for messages. \param[in] others further files
 * \param[out] numbers of the frame of each point
 */
Error
mergeFrames(const std::string& name, const std::vector<std::string>& others, PointFile& first,
            std::vector<std::uint32_t>& numbers);

/** \brief Numbers the frames of a cloud by the values of a field, in ascending order.
 * \return an error where there is no such field or one of its values is not finite. O(points log frames). */
Error
framesByField(const pcl::PCLPointCloud2& cloud, const std::string& field,
              std::vector<std::uint32_t>& numbers);

}  // namespace pcl_slim

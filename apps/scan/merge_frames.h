// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief Appends the points of further registered frames to those of a first one.
 *
 * The points become one row, in the order of the files; the fields vp_x vp_y vp_z have the place that each was seen
 * from: a frame's own fields of these names or, where they are missing or 0, its VIEWPOINT. \return an error for a frame that cannot be
 * read, has other fields than the first, or has faces. O(points).
 * \param[in] name of the first frame's file, for messages. \param[in] others further files
 * \param[out] places how many VIEWPOINTs the frames have; of frames with fields, each counts as one
 */
Error
mergeFrames(const std::string& name, const std::vector<std::string>& others, PointFile& first,
            std::size_t& places);

}  // namespace pcl_slim

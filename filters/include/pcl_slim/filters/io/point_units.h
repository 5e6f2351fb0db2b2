// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief No error for points whose x y z are lengths of one unit, as surfaces need them.
 *
 * x and y are taken for degrees of longitude and latitude where all of them are in the range of degrees,
 * and the file says so (PointFile::degrees) or the extent in z is more than 50 times those in x and y,
 * which are small against their distance from 0. O(points). \return what shows it, and the command that
 * reprojects the file. \param[in] path of the file, for the error. */
PCL_SLIM_EXPORT Error checkLengths(const PointFile& file, const std::string& path);

}  // namespace pcl_slim

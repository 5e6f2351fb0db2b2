// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** No error where this build has VTK's reader and writer; otherwise says what to name instead of
 * path. The functions below give the same error then. */
Error
checkVtp(const std::string& path);

/** Writes float fields as ParaView PolyData: points with vertex cells, "Normals", one array for
 * each other field, comments as a string array of the field data. */
Error
saveVtp(const std::string& path, const PointFile& file);

/** Reads points, normals and scalar arrays of a .vtp file into fields. */
Result<PointFile>
loadVtp(const std::string& path);

}  // namespace pcl_slim

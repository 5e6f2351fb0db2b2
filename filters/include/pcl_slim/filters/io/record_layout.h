// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/stream/record_source.h"

namespace pcl_slim {

/** \brief Where a file has its points, for reading it in pieces (RecordSource), from its header
 * alone.
 *
 * .pcd       ascii, binary
 * .ply       ascii, binary of either order; vertices after elements without lists
 * .f32 .f64  no header: float or double triplets x y z, little-endian
 *
 * \param[in] use_normals whether normals are wanted: fields normal_x normal_y normal_z (nx ny nz).
 * \return an error for a file that cannot be read, is truncated or has no x y z;
 * ErrorCode::kBadArgument and what helps where it is a cloud, but can only be read as a whole:
 * compressed data, other formats, and normals that come from a mesh's faces.
 */
PCL_SLIM_EXPORT Result<RecordLayout> recordLayoutOf(const std::string& path, bool use_normals);

/** \brief Whether a file's extension is one of those that have no header and are read in pieces
 * only. */
PCL_SLIM_EXPORT bool isRawPointFile(const std::string& path);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief Whether a file's fields are those of discs: a radius, and no polynomials (those of a
 * surface have c0). */
PCL_SLIM_EXPORT bool holdsSplats(const PointFile& file);

/** \brief Discs from a file: what toPointFile() wrote, or another program has rewritten.
 *
 * Needs x y z, normal_x normal_y normal_z and radius. Colours come from rgba or rgb (white
 * without), gradients from red_x ... blue_z if all nine are there, confidence (1) and curvature
 * (0) if they are. World coordinates are the file's plus the shift of its comments. kept is the
 * index in the file. \param[out] skipped discs left out (may be null): a value is not finite, the
 * radius below 0 or the normal 0. \return an error that names the missing field. O(points).
 */
PCL_SLIM_EXPORT Result<SplatSet> splatsFrom(const PointFile& file,
                                            std::uint64_t* skipped = nullptr);

}  // namespace pcl_slim

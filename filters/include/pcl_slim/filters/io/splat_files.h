// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief What to subtract from world coordinates for which float is too coarse: fileShift() of the
 * discs' box. Give toPointFile() that of the cloud itself, where there is one: files of its surface
 * have it, too. */
PCL_SLIM_EXPORT std::array<double, 3> splatShift(const SplatSet& splats);

/** \brief Splats as a file: the fields of pcl::PointSurfel first, whose curvature is the surface
 * variation of the 30 centres around (surfaceVariation(), 0 where there are too few); then, where
 * there are gradients, red_x red_y red_z green_x ... blue_z (0..255 per unit of length), in world
 * coordinates less the shift. Comment lines "pcl_slim key value" contain the shift and mark the
 * file as splats. */
PCL_SLIM_EXPORT PointFile toPointFile(const SplatSet& splats, const std::array<double, 3>& shift);

/** \brief Whether a file's fields are those of discs: a radius, and no polynomials (those of a
 * surface have c0). */
PCL_SLIM_EXPORT bool holdsSplats(const PointFile& file);

/** \brief Discs from a file: what toPointFile() wrote, or another program has rewritten.
 *
 * Needs x y z, normal_x normal_y normal_z and radius. Colours come from rgba or rgb (white
 * without), gradients from red_x ... blue_z if all nine are there, confidence (1) if it is there;
 * normal_variance, which files do not have, is 0. World coordinates are the file's plus the shift
 * of its comments. kept is the index in the file. \param[out] skipped discs left out (may be null):
 * a value is not finite, the radius below 0 or the normal 0. \return an error that names the
 * missing field. O(points).
 */
PCL_SLIM_EXPORT Result<SplatSet> splatsFrom(const PointFile& file,
                                            std::uint64_t* skipped = nullptr);

}  // namespace pcl_slim

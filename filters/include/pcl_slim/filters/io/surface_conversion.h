// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_cloud.h>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/filters/point_slim.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Writes a surface's surfels as points, in their order, in world units less the shift.
 *
 * Every number is exact: fromPCL with the returned metadata gives the same surface, bit by bit, but
 * for trim maps, which points carry at 8 x 8 nodes (coarse where a ball is wider than a dozen
 * spacings), and colours, for which PointSLIM has no fields. Files of saveSurface() keep both as
 * they are. O(surfels). An empty surface gives an empty cloud.
 */
PCL_SLIM_EXPORT SurfaceMetadata toPCL(const SLIMSurface& surface,
                                      pcl::PointCloud<PointSLIM>& cloud);

/** \brief The same with the fields of toPointTable(), colours among them. */
PCL_SLIM_EXPORT SurfaceMetadata toPCL(const SLIMSurface& surface, pcl::PCLPointCloud2& cloud);

/** \brief Makes a surface of surfels, with its links, as surfaceFrom() does. */
PCL_SLIM_EXPORT Result<SLIMSurface> fromPCL(const pcl::PointCloud<PointSLIM>& cloud,
                                            const SurfaceMetadata* metadata = nullptr);

/** \brief The same from fields of any numeric type, found by name. */
PCL_SLIM_EXPORT Result<SLIMSurface> fromPCL(const pcl::PCLPointCloud2& cloud,
                                            const SurfaceMetadata* metadata = nullptr);

}  // namespace pcl_slim

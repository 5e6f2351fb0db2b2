// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/point_cloud.h>

#include <array>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/point_slim.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What a cloud of surfels does not contain: the surface's info, and the cloud's position.
 *
 * world = shift + cloud coordinates. The shift is 0 unless float cannot represent the centres in
 * world coordinates (an origin far from the object); it is then fileShift(), which splats of the
 * same cloud have as well.
 */
struct SurfaceMetadata {
  SurfaceInfo info;
  std::array<double, 3> shift{};
};

/** \brief Writes a surface's surfels as points, in their order, in world units less the shift.
 *
 * Every number is exact: fromPCL with the returned metadata gives the same surface, bit by bit, but
 * for trim maps, which points carry at 8 x 8 nodes (coarse where a ball is wider than a dozen
 * spacings), and colours, for which PointSLIM has no fields. Files of saveSurface() keep both as
 * they are. O(surfels). An empty surface gives an empty cloud.
 */
PCL_SLIM_EXPORT SurfaceMetadata toPCL(const SLIMSurface& surface,
                                      pcl::PointCloud<PointSLIM>& cloud);

/** \brief The same as a field-described cloud with only the coefficients info.degree needs, and
 * without trim maps where every surfel is closed. Of a coloured surface it has colours: rgb at the
 * centres, and the polynomial's other terms in red_u green_u blue_u red_v ... red_vv ..., in 1/255
 * of white. */
PCL_SLIM_EXPORT SurfaceMetadata toPCL(const SLIMSurface& surface, pcl::PCLPointCloud2& cloud);

/** \brief Makes a surface of surfels, with its links.
 *
 * \param[in] metadata what toPCL returned; null: degree, scale and origin are derived from the
 * points, everything else takes SurfaceInfo's defaults, and normals count as not oriented.
 * \return an error when a surfel is not usable (NaN, radius not positive, degree not 1..4).
 */
PCL_SLIM_EXPORT Result<SLIMSurface> fromPCL(const pcl::PointCloud<PointSLIM>& cloud,
                                            const SurfaceMetadata* metadata = nullptr);

/** \brief The same from fields of any numeric type, found by name.
 *
 * Needed are x y z, normal_x.., radius and c0 c1 c2; degree, level, leaf, error and confidence have
 * defaults (the highest degree whose coefficients are there, 1, 1, 0, 0). Where there is rgb or
 * rgba, the surface is coloured.
 */
PCL_SLIM_EXPORT Result<SLIMSurface> fromPCL(const pcl::PCLPointCloud2& cloud,
                                            const SurfaceMetadata* metadata = nullptr);

/** \brief The metadata as lines "pcl_slim key value", which files carry as comments. */
PCL_SLIM_EXPORT std::vector<std::string> toComments(const SurfaceMetadata& metadata);

/** \brief Reads the metadata among a file's comments.
 *
 * \param[out] found whether there were any. \return an error for a value that cannot be read or
 * for lines a newer version wrote.
 */
PCL_SLIM_EXPORT Error fromComments(const std::vector<std::string>& comments,
                                   SurfaceMetadata& metadata, bool& found);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Writes a surface by extension (upper or lower case), seen under its name only when whole.
 *
 * - .pcd: binary PCD, for pcl_viewer; metadata in '#' lines
 * - .ply: binary_little_endian, plain float properties, for MeshLab and CloudCompare; metadata in
 *   comment lines
 * - .vtp: for ParaView: vertex cells, "Normals", one array a field; metadata as field data; in builds
 *   with PCL_SLIM_WITH_VTP
 * - .pvtp: for ParaView: an index of .vtp files, here of one (saveSurfacePieces)
 * - .slim: the compact form of surface/surface_io.h
 *
 * Trim maps of other than 8 x 8 nodes are in further such lines, colours in fields
 * (toPointTable). Loading and saving again gives the same bytes in every format, unless
 * they are rounded. Textures are kept in .slim alone: elsewhere surfels have their polynomials.
 * \param[in] rounding of a .slim, as that of saveSlim; with another format one above 0 is an error
 */
PCL_SLIM_EXPORT Error saveSurface(const std::string& path, const SLIMSurface& surface,
                                  const SlimRounding& rounding = {});

/** \brief Writes a surface in blocks for ParaView, a block after another: NAME.pvtp is an index,
 * the folder NAME next to it has NAME_0.vtp, NAME_1.vtp ..., one a block, each as saveSurface()
 * writes it. */
PCL_SLIM_EXPORT Error saveSurfacePieces(const std::string& path, SlimBlockReader& blocks);

/** \brief Reads what saveSurface wrote, and surfels other programs have rewritten.
 *
 * When a program dropped the metadata, units come from the points (surfaceFrom). A missing, foreign,
 * truncated, corrupted or newer file gives an error that names the defect.
 */
PCL_SLIM_EXPORT Result<SLIMSurface> loadSurface(const std::string& path);

/** \brief The surface in a point file's fields and comments. \return an error that names what is
 * missing or wrong. */
PCL_SLIM_EXPORT Result<SLIMSurface> surfaceFrom(const PointFile& file);

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

/** \brief A surface's surfels as points, in their order, in world units less the shift: the fields of
 * PointSLIM with only the coefficients info.degree needs, and without trim maps where every surfel
 * is closed. Of a coloured surface it has colours: rgb at the centres, and the polynomial's other
 * terms in red_u green_u blue_u red_v ... red_vv ..., in 1/255 of white. O(surfels). */
PCL_SLIM_EXPORT SurfaceMetadata toPointTable(const SLIMSurface& surface, PointTable& cloud);

/** \brief Makes a surface of surfels, with its links, from fields of any numeric type.
 *
 * Needed are x y z, normal_x.., radius and c0 c1 c2; degree, level, leaf, error and confidence have
 * defaults (the highest degree whose coefficients are there, 1, 1, 0, 0). Where there is rgb or
 * rgba, the surface is coloured.
 * \param[in] metadata what toPointTable() returned; null: degree, scale and origin are derived from
 * the points, everything else takes SurfaceInfo's defaults, and normals count as not oriented.
 * \return an error when a surfel is not usable (NaN, radius not positive, degree not 1..4).
 */
PCL_SLIM_EXPORT Result<SLIMSurface> surfaceFrom(const PointTable& cloud,
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

/** \brief Whether the extension is one this build's saveSurface knows; names those it does
 * otherwise. */
PCL_SLIM_EXPORT Error checkSurfaceExtension(const std::string& path);

}  // namespace pcl_slim

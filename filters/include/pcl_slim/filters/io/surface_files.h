// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Writes a surface by extension (upper or lower case), seen under its name only when whole.
 *
 * .pcd   binary PCD, for pcl_viewer; metadata in '#' lines
 * .ply   binary_little_endian, plain float properties, for MeshLab and CloudCompare; metadata in
 *        comment lines
 * .vtp   for ParaView: vertex cells, "Normals", one array a field; metadata as field data;
 *        in builds with PCL_SLIM_WITH_VTP
 * .pvtp  for ParaView: an index of .vtp files, here of one (saveSurfacePieces)
 * .slim  the compact form of surface/surface_io.h
 *
 * Trim maps of other than 8 x 8 nodes are in further such lines, colours in fields
 * (surface_conversion.h). Loading and saving again gives the same bytes in every format, unless
 * they are rounded.
 * \param[in] rounding of a .slim, as that of saveSlim; with another format one above 0 is an error
 */
PCL_SLIM_EXPORT Error saveSurface(const std::string& path, const SLIMSurface& surface,
                                  double rounding = 0.0);

/** \brief Writes a surface in blocks for ParaView, a block after another: NAME.pvtp is an index,
 * the folder NAME next to it has NAME_0.vtp, NAME_1.vtp ..., one a block, each as saveSurface()
 * writes it. */
PCL_SLIM_EXPORT Error saveSurfacePieces(const std::string& path, SlimBlockReader& blocks);

/** \brief Reads what saveSurface wrote, and surfels other programs have rewritten.
 *
 * When a program dropped the metadata, units come from the points (fromPCL). A missing, foreign,
 * truncated, corrupted or newer file gives an error that names the defect.
 */
PCL_SLIM_EXPORT Result<SLIMSurface> loadSurface(const std::string& path);

/** \brief The surface in a point file's fields and comments. \return an error that names what is
 * missing or wrong. */
PCL_SLIM_EXPORT Result<SLIMSurface> surfaceFrom(const PointFile& file);

/** \brief Whether the extension is one this build's saveSurface knows; names those it does
 * otherwise. */
PCL_SLIM_EXPORT Error checkSurfaceExtension(const std::string& path);

}  // namespace pcl_slim

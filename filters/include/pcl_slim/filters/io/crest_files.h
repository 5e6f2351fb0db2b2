// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief How an SVG shows lines: in parallel projection. */
struct CrestView {
  Vector3 toward_viewer = {0, 0, 1};  ///< from the object, any length but 0
  Vector3 up = {0, 1, 0};             ///< points up in the picture
  double width = 1000;                ///< of the longer side, pixels
  double line_width = 1.2;            ///< pixels
  /** Hides lines behind it: leaves are drawn as flat patches of two thirds of their radius, so that
   * lines within half a radius of what hides them may show. Null: every line shows. */
  const SLIMSurface* surface = nullptr;
};

/** \brief Writes lines by extension (upper or lower case); the file appears only when complete.
 *
 * - .vtp: for ParaView: one polyline cell a line with type, length, strength, significance; point
 *   data
 * - .ply: binary_little_endian, `element edge` with vertex1 and vertex2
 * - .pcd: binary; a `line` field has the number of each vertex' line
 * - .svg: ridges blue and ravines red, as seen from that side (a ridge seen from behind is a ravine)
 *
 * Coordinates are floats unless that would move a vertex by a thousandth of its distance from the
 * next.
 */
PCL_SLIM_EXPORT Error saveCrestLines(const std::string& path, const CrestLines& lines,
                                     const CrestView& view = {});

/** \brief Whether saveCrestLines supports the extension; otherwise an error that names those it
 * supports. */
PCL_SLIM_EXPORT Error checkCrestExtension(const std::string& path);

/** \brief Lines as points with the fields of PointCrest; x y z of either precision. O(vertices). */
PCL_SLIM_EXPORT PointFile toPointFile(const CrestLines& lines);

/** \brief The text of an SVG of the lines. */
PCL_SLIM_EXPORT std::string crestSvg(const CrestLines& lines, const CrestView& view);

}  // namespace pcl_slim

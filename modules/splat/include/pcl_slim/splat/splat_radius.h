// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** \brief How large discs become. */
enum class RadiusRule : unsigned char {
  kDensity,  ///< to the farthest of the cell's n points, and some spacings: densityRadius (default)
  kNeighbors,  ///< to halfway towards neighbours in other cells, and .35 spacings more
  kCorner      ///< to the farthest corner of the cell, as the paper has it: large, and never short
};

/** \brief Distance from a point to the farthest corner of a cube. All in one unit. */
PCL_SLIM_EXPORT double cornerRadius(const std::array<double, 3>& point,
                                    const std::array<double, 3>& cube_center, double edge);

/** \brief A cell's mean distance between points [root cells; 0: unknown], and how many it has. */
struct CellSpacing {
  float spacing;
  std::uint32_t points;
};

/** \brief A spacing this many times the middle one is the widest that counts. */
constexpr double kWidestSpacings = 6.0;

/** \brief Spacings wider than this are cut to it: outliers would get discs of any size. kWidestSpacings
 * times the middle spacing over cells, weighted by their points; 0 if no cell knows its spacing. The
 * cells are reordered. */
PCL_SLIM_EXPORT double widestSpacing(std::vector<CellSpacing>& cells);

/** \brief Radius by kDensity [root cells]: the farthest of the cell's n points, and 1 + .3 /
 * sqrt(n) + .5 bend spacings. Few points give a poor estimate of the spacing around them, and where
 * normals differ rays pass a disc aslant. \param[in] reach distance to the farthest of the cell's
 * points.
 * \param[in] bend standard deviation of its normals, noise taken off. \param[in] widest
 * widestSpacing(). */
PCL_SLIM_EXPORT double densityRadius(double reach, double points, double bend, double spacing,
                                     double widest);

/** \brief Radii of all discs by kNeighbors [root cells].
 *
 * A point's spacing is the mean distance to its 6 nearest; neighbours are its 8 nearest, as far as
 * 2 widest spacings. \param[in] centers of the discs, in root cells. \param[in] disc_of the disc of
 * each point, by the i of CloudView::inputIndex. \param[in] store the same points. About a
 * microsecond a point.
 */
PCL_SLIM_EXPORT std::vector<float> neighborRadii(const OctreeCloud& cloud,
                                                 const std::vector<std::array<float, 3>>& centers,
                                                 const std::vector<std::uint32_t>& disc_of,
                                                 const PointStore& store, double widest,
                                                 int threads);

}  // namespace pcl_slim

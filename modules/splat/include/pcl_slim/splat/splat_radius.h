// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/splat/color_octree.h"

namespace pcl_slim {

/** \brief How large discs become. */
enum class RadiusRule : unsigned char {
  kDensity,    ///< to the cell's farthest point, and one spacing more (default)
  kNeighbors,  ///< to halfway towards neighbours in other cells, and .35 spacings more
  kCorner      ///< to the farthest corner of the cell, as the paper has it: large, and never short
};

/** \brief A disc in OctreeCloud's units. */
struct Disc {
  std::array<double, 3> center{}, normal{};
};

/** \brief Distance from a point to the farthest corner of a cube. All in one unit. */
double
cornerRadius(const std::array<double, 3>& point, const std::array<double, 3>& cube_center,
             double edge);

/** \brief Largest distance from the disc's centre to the cell's points [root cells]. O(points of the
 * cell). */
double
reachOfPoints(const OctreeCloud& cloud, const OctreeCell& cell, const Disc& disc);

/** \brief Spacings wider than this are cut to it: outliers would get discs of any size. A multiple
 * of the middle spacing over cells, weighted by their points; 0 if no cell knows its spacing. */
double
widestSpacing(const std::vector<OctreeCell>& cells);

/** \brief Radii by kDensity [root cells]. \param[in] reach reachOfPoints of each cell.
 * \param[in] widest widestSpacing(). */
double
densityRadius(const OctreeCell& cell, double reach, double widest);

/** \brief Radii of all cells by kNeighbors [root cells]; discs one per cell.
 *
 * A point's spacing is the mean distance to its 6 nearest; neighbours are its 8 nearest, as far as
 * 2 widest spacings. \param[in] store the same points. About a microsecond a point.
 */
std::vector<float>
neighborRadii(const OctreeCloud& cloud, const std::vector<OctreeCell>& cells,
              const std::vector<Disc>& discs, const PointStore& store, int threads);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Components of fewer points are left out of pictures, pages, meshes and samples, unless
 * another number is given. */
inline constexpr double kLeastComponentPoints = 50;

/** \brief What dropComponents() has removed. */
struct DroppedComponents {
  std::uint64_t components = 0;
  std::uint64_t leaves = 0;  ///< removed as a whole; others have lost a part of their trim maps
  double points = 0;         ///< about
  std::uint64_t kept = 0;    ///< components that stay; 0 where none was looked for
};

/** \brief Removes what is connected to fewer points than required: leaves, regions of their trim
 * maps, and internal surfels that have no other leaves below them.
 *
 * A component consists of connected regions of leaves' trim maps. Two regions are connected if a
 * place of one, within its ball, is within the other and at most .3 of a radius from its sheet. The
 * points of a component are estimated from its leaves' effective counts; points that several leaves
 * have count once. The component of most points always stays. What stays keeps its order, and links
 * are made anew. O(M log M) for M surfels; the same for any number of threads.
 *
 * A surface with which points are smoothed should keep all of its leaves: this is for what is drawn
 * or sampled.
 * \param[in] min_points 0: all stay
 * \param[in] unloaded boxes in world coordinates, of parts of the surface that are not there: a
 * component that reaches into one stays */
PCL_SLIM_EXPORT DroppedComponents
dropComponents(double min_points, SLIMSurface& surface, int threads = 1,
               const std::vector<std::array<std::array<double, 3>, 2>>& unloaded = {});

}  // namespace pcl_slim

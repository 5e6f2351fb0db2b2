// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Units of a PointStore, and which points of a cloud belong into it: what all tiles of one
 * cloud share, so that their points have the same coordinates and keys as in one store of all of
 * them. */
struct StoreFrame {
  std::array<double, 3> origin{};       ///< world position of local 0
  double scale = 1.0;                   ///< world units per local unit, a power of two
  double diagonal = 0.0;                ///< L, the bounding box's diagonal, local units
  double bulk_diagonal = 0.0;           ///< L of the bulk alone, local units
  double center_grid = 0x1p-22;         ///< surfel centres are multiples of this
  std::array<double, 3> bulk_center{};  ///< points outside the cube about this place are strays ...
  double bulk_reach = 0.0;              ///< ... half the cube's edge, world units
  double bulk_between = 0.0;            ///< diagonal of the box between the quartiles, world units
  bool with_normals = false;            ///< points without a normal are left out
  std::optional<std::array<double, 3>> sensor;  ///< world position that points were seen from
};

/** \brief The points of a cloud but for the strays that a PointStore leaves out, for CloudView::indices;
 * empty where there is none. Points that are not finite are kept. O(points).
 * \param[in] threads 0: all cores; never changes the result */
PCL_SLIM_EXPORT std::vector<std::int32_t> withoutStrays(const CloudView& cloud, int threads);

/** \brief What files of floats leave out of world coordinates, so that all files made of one cloud
 * have the same place in a viewer: 0 unless the cloud is 256 of its diagonals or more from the
 * world's origin, else a place near its middle, a multiple of four diagonals.
 * \param[in] origin of a store's or surface's local units \param[in] scale world units per local
 * one */
PCL_SLIM_EXPORT std::array<double, 3> fileShift(const std::array<double, 3>& origin, double scale);

/** \brief The same of a box around a cloud's points, in world coordinates. */
PCL_SLIM_EXPORT std::array<double, 3> fileShift(const std::array<double, 3>& low,
                                                const std::array<double, 3>& high);

/** \brief The same of a cloud's finite points. O(points). */
PCL_SLIM_EXPORT std::array<double, 3> fileShift(const CloudView& cloud);

}  // namespace pcl_slim

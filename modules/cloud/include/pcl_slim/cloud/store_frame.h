// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace pcl_slim {

/** \brief Units of a PointStore, and which points of a cloud belong into it: what all tiles of one cloud
 * share, so that their points have the same coordinates and keys as in one store of all of them. */
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

}  // namespace pcl_slim

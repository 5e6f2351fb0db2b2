// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"
#include "tree/box_tree.h"

namespace pcl_slim::detail {

/** \brief A leaf's polynomial in the ball within which leaves cover points. */
struct LeafPatch {
  Vector3 center;
  LocalFrame frame;
  double radius;
  double reach;  ///< of that ball [radii]
  double error;  ///< RMS residual of its fit
  int degree;
  const float* coefficients;
  TrimMap trim;
};

/** \brief A place of a patch. */
struct PatchFoot {
  double distance_sq = Bounds::kInfinity;  ///< infinite: the patch has no place
  Vector3 position{};
  Vector3 normal{};     ///< unit
  bool border = false;  ///< the nearest place of the ball is outside of the data
};

/** \brief A surface's patches in the order of a tree over their boxes and normals. */
struct PatchIndex {
  explicit PatchIndex(const SLIMSurface& surface, int threads);

  std::vector<LeafPatch> patches;
  BoxTree tree;
  Bounds bounds;  ///< of all patches
};

/** \brief The place of a patch that is nearest to a place: Newton's method for the squared distance,
 * which stays in the ball. Where the place found is outside of the data, as the trim map has them,
 * the node of the map inside that is nearest to it. O(1); O(nodes) beyond borders. Exact to a
 * hundredth of a radius, which is enough to choose a patch and to begin on the blended surface. */
PatchFoot nearestOnPatch(const LeafPatch& patch, const Vector3& place);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A sphere that encloses a piece of an object, and that piece's normal. */
struct BoundingSphere {
  std::array<float, 3> center;
  float radius;
  std::array<float, 3> normal;  ///< unit length, to the side that was seen; 0: unknown
  float points = 1;             ///< scanned points behind the piece: what it weighs in a view
};

/** \brief An object as the spheres that enclose its pieces: what cameras look at.
 *
 * Lengths are in local units: world = origin + scale * local.
 */
struct BoundingSpheres {
  std::vector<BoundingSphere> spheres;
  std::array<double, 3> origin{};
  double scale = 1.0;
  double diagonal = 1.0;     ///< of the object's bounding box
  double seen_radius = 1.0;  ///< share of each radius that a picture has to show
  bool no_strays = false;    ///< a picture has to show every sphere, however far from the bulk
};

/** \brief The leaves' balls of a surface; of one that has no leaf but links, as the levels above
 * tiles do, the balls with none below them. O(surfels). */
PCL_SLIM_EXPORT BoundingSpheres spheresOf(const SLIMSurface& surface);

/** \brief The discs of a set, which must be valid (validateDiscs). O(discs). */
PCL_SLIM_EXPORT BoundingSpheres spheresOf(const SplatSet& splats);

/** \brief The triangles of a mesh, large ones in pieces, which weigh what they measure, as their
 * corners are counter-clockwise seen from outside; corners must be finite. O(triangles). */
PCL_SLIM_EXPORT BoundingSpheres
spheresOf(const std::vector<Vector3>& corners,
          const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace pcl_slim

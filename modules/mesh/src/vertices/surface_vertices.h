// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "contour/polygons.h"
#include "contour/probe_blocks.h"

namespace pcl_slim::detail {

/** Vertices on the surface, local units. */
struct SurfaceVertices {
  std::vector<Vector3> position, normal;
  std::vector<float> k1, k2;
  std::vector<float> outside;           ///< share of the trim maps: the surface ends at 1/2
  std::vector<float> size;              ///< of cells about
  std::vector<std::uint8_t> supported;  ///< 0: not on the surface, but where cells' edges cross it

  std::size_t count() const { return position.size(); }
  void resize(std::size_t count);
};

/** Puts each vertex onto the surface next to it (equations 6 and 7, twice), along its normal's side. Those that
 * no leaf supports, or that would leave their cells, stay. O(vertices times leaves near each). */
void
putOnSurface(const ProbeField& field, std::vector<std::uint32_t> which, SurfaceVertices& vertices);

/** Moves vertices towards the middle of those they are connected to, along the surface, in several passes.
 * A vertex stays where a triangle would turn over; so do those on borders. */
void
relax(const ProbeField& field, const std::vector<Triangle>& triangles, int rounds,
      SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// Closing border loops of a mesh by triangles of its own kind.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/** Vertices of a border loop, in the order in which a face that closes it has them. */
using Loop = std::vector<std::uint32_t>;

/** What a mesh has next to its border. */
class BorderRings {
 public:
  /** Of a mesh whose vertices have one fan of triangles each. O(T log T). */
  BorderRings(const std::vector<Triangle>& triangles, const SurfaceVertices& vertices, int threads);

  /** The border loops, by their least vertices. */
  const std::vector<Loop>& loops() const { return loops_; }
  /** Vertices connected to one on the border, ascending; none for others. */
  IndexRow neighbours(std::uint32_t v) const;
  /** Triangles about a vertex on the border, by number; none for others. */
  IndexRow trianglesAt(std::uint32_t v) const;
  /** The unit normal of the triangle at the border edge that begins at v in its loop. */
  const Vector3& normalAt(std::uint32_t v) const { return normals_[slot_[v]]; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::uint32_t> slot_;  ///< of each vertex; kNone: it is not on the border
  std::vector<std::uint32_t> begin_, neighbours_, fan_begin_, fans_;
  std::vector<Vector3> normals_;
  std::vector<Loop> loops_;
};

/** Triangles that close a loop. Corners below the loop's size are its vertices, the others are new.
 */
struct LoopFill {
  std::vector<Triangle> triangles;
  std::vector<Vector3> positions;  ///< of the loop's vertices, then of the new ones
  std::vector<double> sizes;       ///< edges that triangles about each should have
  double area = 0;

  Vector3 areaOf(const Triangle& t) const {
    return cross(subtract(positions[t[1]], positions[t[0]]),
                 subtract(positions[t[2]], positions[t[0]]));
  }
};

/** Connects a loop's vertices by triangles. The corner whose triangle has the least circumscribed
 * circle is cut off first, which is nearly a Delaunay triangulation; corners whose triangle would
 * fold back onto the mesh, or contain another vertex of the loop, come last. No edge of the mesh is
 * used twice; where that leaves no corner, the rest becomes a fan about a new vertex. O(n log n),
 * with up to n distances for each corner cut. */
LoopFill connectLoop(const Loop& loop, const BorderRings& rings, const SurfaceVertices& vertices);

/** Divides triangles at their centroids until they are about as large as those around the loop, and
 * larger away from it, and flips edges until they are Delaunay (Liepa: Filling holes in meshes, SGP
 * 2003). O(triangles made, log). */
void refineFill(const Loop& loop, const BorderRings& rings, LoopFill& fill);

/** Moves the new vertices: to the thin plate that continues the mesh around the loop where the
 * triangles do so at all, to a membrane where they are across its end; by cotangent weights, which
 * are exact on planes. O(n) for the n vertices of a fill, about, and a sparse factorisation. */
void fairFill(const Loop& loop, const BorderRings& rings, const std::vector<Triangle>& triangles,
              const SurfaceVertices& vertices, LoopFill& fill);

/** Closes a loop by all three steps, and appends the triangles and the new vertices, with normals
 * and without curvature. */
LoopFill fillLoop(const Loop& loop, const BorderRings& rings, std::vector<Triangle>& triangles,
                  SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

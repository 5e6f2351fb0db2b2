// SPDX-License-Identifier: BSD-3-Clause
// Where a mesh ends: trimming, holes, and pieces that are left out.
#pragma once

#include <cstdint>
#include <vector>

#include "contour/contour.h"
#include "fill/loop_fill.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

/// Spacings by which a hole of the mesh is narrower than the gap between its points: each owns half
/// a spacing about it, and trim maps have corners rounded.
constexpr double kGrowth = 2;

/** Points of the data in an area [local units] at some vertices: the effective number of points of
 * the leaves there over the area of their balls that has data. 0 where there is no leaf. */
std::vector<double> densitiesAt(const ProbeField& field, const std::vector<std::uint32_t>& which,
                                const SurfaceVertices& vertices);

/** Area of a triangle, local units. */
double areaOf(const Triangle& triangle, const SurfaceVertices& vertices);

/** A straight piece of a border in a plane. */
struct BorderPiece {
  double from[2], to[2];
};

/** The diameter of the largest disc that no piece of a border crosses, among the places inside:
 * those from which a ray meets an odd number of pieces. To a hundredth of the diameter; `least` if
 * there is none larger, and any size from `most` on if there is one. O(pieces) for each square that
 * may contain the middle of a larger disc. */
double widestDisc(const std::vector<BorderPiece>& border, double least, double most);

/** Straight pieces in the plane across a normal. */
class PlaneView {
 public:
  PlaneView(const Vector3& origin, const Vector3& normal);
  BorderPiece piece(const Vector3& from, const Vector3& to) const;

 private:
  Vector3 origin_, u_{}, v_{};
};

/** Which loops are closed. */
struct LoopChoice {
  double width = 0;      ///< narrower ones [spacings], but no ends of sheets
  bool all = false;      ///< all of them
  bool inside = false;   ///< only loops all of whose vertices are inside the trim maps
  bool project = false;  ///< the new vertices are put onto the surface, where it supports them
};

/** What was closed. */
struct ClosedLoops {
  std::uint64_t count = 0;
  double area = 0;  ///< local units
};

/** Closes border loops. O(T log T). */
ClosedLoops closeLoops(const ProbeField& field, const LoopChoice& choice,
                       std::vector<Triangle>& triangles, SurfaceVertices& vertices);

/** Counts the loops that a mesh has. */
void countLoops(const ProbeField& field, double scale, const std::vector<Triangle>& triangles,
                const SurfaceVertices& vertices, MeshStatistics& statistics);

/** Leaves out components with fewer points than requested; the largest is always kept. O(T). */
void dropCrumbs(const ProbeField& field, double min_points, const SurfaceVertices& vertices,
                std::vector<Triangle>& triangles, MeshStatistics& statistics);

/** Marks as outside the vertices that no leaf supports or that leaves cover less than a fit covers
 * its points: polynomials err there, and trim maps do not reach there. */
void markUncovered(const ProbeField& field, double threshold, SurfaceVertices& vertices);

/** Cuts triangles where the surface's data end: along the line on which SurfaceVertices::outside is
 * 1/2. Vertices next to that line are brought onto it, others are on edges that it crosses. Then
 * edges on the border whose middle is farther from that line than the tolerance [local units], and
 * than .15 spacings of the points, are divided there. Vertices are added, none is taken away. O(T),
 * and a few evaluations for each edge that the line crosses. */
void trimAtBorder(const ProbeField& field, double tolerance, std::vector<Triangle>& triangles,
                  SurfaceVertices& vertices);

}  // namespace pcl_slim::detail

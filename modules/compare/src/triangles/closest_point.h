// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Parts of a triangle: its face, edges from corner k to the next, and corners. */
enum class Part : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kCorner0, kCorner1, kCorner2 };

/** \brief The number of a triangle's edge or corner. */
inline std::size_t edgeOf(Part part) {
  return static_cast<std::size_t>(part) - static_cast<std::size_t>(Part::kEdge0);
}
inline std::size_t cornerOf(Part part) {
  return static_cast<std::size_t>(part) - static_cast<std::size_t>(Part::kCorner0);
}
inline bool isEdge(Part part) {
  return part >= Part::kEdge0 && part <= Part::kEdge2;
}
inline bool isCorner(Part part) {
  return part >= Part::kCorner0;
}

/** \brief Corners of a triangle, and how it is searched. */
struct PlacedTriangle {
  std::array<Vector3, 3> corner;
};

/** \brief How a triangle's height over its longest edge compares with that edge. */
enum class TriangleShape : std::uint8_t {
  kRegular,
  kSliver,  ///< barycentric coordinates from products of edges would be rounding errors
  kFlat,    ///< has no normal
};

TriangleShape shapeOf(const PlacedTriangle& triangle);

/** \brief The place of a triangle that is nearest to a place. */
struct ClosestPoint {
  double distance_sq = 0;
  Vector3 position{};
  std::array<double, 3> weights{};  ///< barycentric
  Part part = Part::kFace;
};

/** \brief Exact but for rounding, for triangles of any shape (Ericson, Real-time collision
 * detection, 2005, section 5.1.5). */
ClosestPoint closestPoint(const PlacedTriangle& triangle, TriangleShape shape, const Vector3& p);

}  // namespace pcl_slim::detail

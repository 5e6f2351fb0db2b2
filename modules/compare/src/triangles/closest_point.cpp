// SPDX-License-Identifier: BSD-3-Clause
#include "triangles/closest_point.h"

#include <algorithm>

namespace pcl_slim::detail {

namespace {

// Of the height over the longest edge. Products of edges have relative rounding errors of 1e-16 of
// the edge squared; those of barycentric coordinates are that over the squared height.
constexpr double kSliverHeight = 1e-4;
constexpr double kFlatHeight = 1e-13;

ClosestPoint weighted(const PlacedTriangle& t, const Vector3& p, Part part,
                      const std::array<double, 3>& weights) {
  ClosestPoint found;
  found.part = part;
  found.weights = weights;
  const Vector3 ab = subtract(t.corner[1], t.corner[0]), ac = subtract(t.corner[2], t.corner[0]);
  found.position = along(along(t.corner[0], weights[1], ab), weights[2], ac);
  const Vector3 off = subtract(p, found.position);
  found.distance_sq = dot(off, off);
  return found;
}

ClosestPoint atCorner(const PlacedTriangle& t, const Vector3& p, std::size_t k) {
  ClosestPoint found;
  found.part = static_cast<Part>(static_cast<std::size_t>(Part::kCorner0) + k);
  found.weights[k] = 1;
  found.position = t.corner[k];
  const Vector3 off = subtract(p, found.position);
  found.distance_sq = dot(off, off);
  return found;
}

ClosestPoint onEdge(const PlacedTriangle& t, const Vector3& p, std::size_t k, double share) {
  std::array<double, 3> weights{};
  weights[k] = 1 - share;
  weights[(k + 1) % 3] = share;
  ClosestPoint found;
  found.part = static_cast<Part>(static_cast<std::size_t>(Part::kEdge0) + k);
  found.weights = weights;
  const Vector3 edge = subtract(t.corner[(k + 1) % 3], t.corner[k]);
  found.position = along(t.corner[k], share, edge);
  const Vector3 off = subtract(p, found.position);
  found.distance_sq = dot(off, off);
  return found;
}

/** By the three edges, then by the plane: for slivers and triangles without a plane. */
ClosestPoint closestOfSliver(const PlacedTriangle& t, bool flat, const Vector3& p) {
  ClosestPoint best;
  best.distance_sq = Bounds::kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 edge = subtract(t.corner[(k + 1) % 3], t.corner[k]);
    const double share = dot(subtract(p, t.corner[k]), edge) / dot(edge, edge);
    const ClosestPoint here = share <= 0   ? atCorner(t, p, k)
                              : share >= 1 ? atCorner(t, p, (k + 1) % 3)
                                           : onEdge(t, p, k, share);
    if (here.distance_sq < best.distance_sq) best = here;
  }
  if (flat) return best;
  const Vector3 ab = subtract(t.corner[1], t.corner[0]), ac = subtract(t.corner[2], t.corner[0]);
  const Vector3 area = cross(ab, ac);
  const Vector3 unit = normalized(area);
  const double height = dot(subtract(p, t.corner[0]), unit);
  const Vector3 q = along(p, -height, unit);
  std::array<double, 3> weights;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 a = subtract(t.corner[(k + 1) % 3], q), b = subtract(t.corner[(k + 2) % 3], q);
    weights[k] = dot(cross(a, b), unit);
    if (weights[k] < 0) return best;
    sum += weights[k];
  }
  for (double& weight : weights) weight /= sum;
  const ClosestPoint inside = weighted(t, p, Part::kFace, weights);
  return inside.distance_sq < best.distance_sq ? inside : best;
}

}  // namespace

TriangleShape shapeOf(const PlacedTriangle& t) {
  double longest_sq = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 edge = subtract(t.corner[(k + 1) % 3], t.corner[k]);
    longest_sq = std::max(longest_sq, dot(edge, edge));
  }
  const Vector3 area =
      cross(subtract(t.corner[1], t.corner[0]), subtract(t.corner[2], t.corner[0]));
  const double height = longest_sq > 0 ? length(area) / longest_sq : 0;
  return height > kSliverHeight ? TriangleShape::kRegular
         : height > kFlatHeight ? TriangleShape::kSliver
                                : TriangleShape::kFlat;
}

ClosestPoint closestPoint(const PlacedTriangle& t, TriangleShape shape, const Vector3& p) {
  if (shape != TriangleShape::kRegular) return closestOfSliver(t, shape == TriangleShape::kFlat, p);
  const Vector3 ab = subtract(t.corner[1], t.corner[0]), ac = subtract(t.corner[2], t.corner[0]);
  const Vector3 ap = subtract(p, t.corner[0]);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return atCorner(t, p, 0);
  const Vector3 bp = subtract(p, t.corner[1]);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return atCorner(t, p, 1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return onEdge(t, p, 0, d1 / (d1 - d3));
  const Vector3 cp = subtract(p, t.corner[2]);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return atCorner(t, p, 2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return onEdge(t, p, 2, 1 - d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return onEdge(t, p, 1, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const double per_sum = 1 / (va + vb + vc);
  return weighted(t, p, Part::kFace, {va * per_sum, vb * per_sum, vc * per_sum});
}

}  // namespace pcl_slim::detail

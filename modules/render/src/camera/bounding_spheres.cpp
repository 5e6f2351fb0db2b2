// SPDX-License-Identifier: BSD-3-Clause
// An object as the balls that enclose its pieces.
#include "pcl_slim/render/bounding_spheres.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

constexpr float kLeastRadius = 1e-3f;  ///< of the extent: a cloud that is one point is seen as well

/** \brief Middle and diagonal of the discs' centres, relative to their origin. */
struct CenterBox {
  std::array<double, 3> middle{};
  double diagonal = 0.0;

  explicit CenterBox(const SplatSet& splats) {
    const std::vector<float>* const columns[3] = {&splats.x, &splats.y, &splats.z};
    double diagonal_sq = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] = std::minmax_element(columns[a]->begin(), columns[a]->end());
      middle[a] = 0.5 * (double{*low} + *high);
      diagonal_sq += (double{*high} - *low) * (double{*high} - *low);
    }
    diagonal = std::sqrt(diagonal_sq);
  }
};

}  // namespace

BoundingSpheres spheresOf(const SLIMSurface& surface) {
  BoundingSpheres object;
  object.origin = surface.info.origin;
  object.scale = surface.info.scale;
  object.diagonal = surface.info.diagonal;
  // A leaf is seen about as far as it covers, not to the rim of its support.
  object.seen_radius = 0.5 * surface.info.cover_radius;
  object.spheres.reserve(surface.size());
  const bool above_leaves = surface.numLeaves() == 0 && !surface.child_begin.empty();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const bool ends = above_leaves && surface.child_begin[i] == surface.child_begin[i + 1];
    if (!surface.isLeaf(i) && !ends) continue;
    object.spheres.push_back({{surface.cx[i], surface.cy[i], surface.cz[i]},
                              surface.radius[i],
                              {surface.nx[i], surface.ny[i], surface.nz[i]},
                              std::max(1.0f, surface.effective_count[i])});
  }
  return object;
}

BoundingSpheres spheresOf(const SplatSet& splats) {
  BoundingSpheres object;
  object.origin = splats.origin;
  object.seen_radius = 0.5;
  if (splats.empty()) return object;

  const CenterBox box(splats);
  for (std::size_t a = 0; a < 3; ++a) object.origin[a] += box.middle[a];
  const double widest = *std::max_element(splats.radius.begin(), splats.radius.end());
  const double extent = std::max(box.diagonal, widest);
  object.scale = extent > 0.0 ? extent : 1.0;
  const auto local = [&](float value, std::size_t axis) {
    return static_cast<float>((value - box.middle[axis]) / object.scale);
  };
  object.spheres.reserve(splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    object.spheres.push_back(
        {{local(splats.x[i], 0), local(splats.y[i], 1), local(splats.z[i], 2)},
         std::max(kLeastRadius, static_cast<float>(splats.radius[i] / object.scale)),
         {splats.nx[i], splats.ny[i], splats.nz[i]},
         std::max(1.0f, splats.confidence[i])});
  }
  return object;
}

namespace {

/** \brief Adds the sphere of a triangle or, while that is longer than a piece, of its quarters. */
void addTriangle(const std::array<Vector3, 3>& corners, double piece, BoundingSpheres& object) {
  constexpr std::size_t kMostPieces = 200000;
  const auto& [a, b, c] = corners;
  const Vector3 area = cross(subtract(b, a), subtract(c, a));
  if (!(length(area) > 0.0)) return;
  const double longest =
      std::max({length(subtract(b, a)), length(subtract(c, b)), length(subtract(a, c))});
  if (longest > piece && object.spheres.size() < kMostPieces) {
    const Vector3 ab = scaled(along(a, 1.0, b), 0.5), bc = scaled(along(b, 1.0, c), 0.5),
                  ca = scaled(along(c, 1.0, a), 0.5);
    for (const auto& quarter :
         {std::array<Vector3, 3>{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      addTriangle(quarter, piece, object);
    return;
  }
  const Vector3 middle = scaled(along(along(a, 1.0, b), 1.0, c), 1.0 / 3.0);
  const Vector3 normal = normalized(area);
  double radius = 0.0;
  for (const Vector3& corner : corners) radius = std::max(radius, length(subtract(corner, middle)));
  BoundingSphere sphere{};
  for (std::size_t k = 0; k < 3; ++k) {
    sphere.center[k] = static_cast<float>(middle[k]);
    sphere.normal[k] = static_cast<float>(normal[k]);
  }
  sphere.radius = std::max(kLeastRadius * 1e-3f, static_cast<float>(radius));
  sphere.points = std::max(1e-30f, static_cast<float>(length(area)));
  object.spheres.push_back(sphere);
}

}  // namespace

BoundingSpheres spheresOf(const std::vector<Vector3>& corners,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  constexpr double kPiece = 1.0 / 24.0;  // of the diagonal
  BoundingSpheres object;
  Bounds box;
  for (const auto& t : triangles) {
    for (const std::uint32_t v : t) box.add(corners[v]);
  }
  if (triangles.empty()) return object;
  object.origin = scaled(along(box.low, 1.0, box.high), 0.5);
  const double extent = box.diagonal();
  object.scale = extent > 0.0 ? extent : 1.0;
  for (const auto& t : triangles) {
    std::array<Vector3, 3> local;
    for (std::size_t k = 0; k < 3; ++k)
      local[k] = scaled(subtract(corners[t[k]], object.origin), 1.0 / object.scale);
    addTriangle(local, kPiece, object);
  }
  return object;
}

}  // namespace pcl_slim

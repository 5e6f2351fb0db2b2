// SPDX-License-Identifier: BSD-3-Clause
#include "borders/mesh_shape.h"

#include <algorithm>
#include <cmath>

#include "borders/mesh_parts.h"

namespace pcl_slim::borders {
namespace {

/** \brief Sets that are joined. */
class Sets {
 public:
  explicit Sets(std::size_t count) {
    above_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) above_.push_back(i);
  }

  std::size_t of(std::size_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { above_[of(i)] = of(j); }

 private:
  std::vector<std::size_t> above_;
};

/** \brief An edge of a triangle, and the corners of the triangle that are its ends. */
struct Side {
  std::uint32_t low, high;      ///< vertices
  std::size_t at_low, at_high;  ///< corners: three a triangle
};

std::vector<Side> sidesOf(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      Side side{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3], 3 * t + k,
                3 * t + (k + 1) % 3};
      if (side.low > side.high) {
        std::swap(side.low, side.high);
        std::swap(side.at_low, side.at_high);
      }
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  return sides;
}

}  // namespace

std::size_t countLoops(const TriangleMesh& mesh) {
  const std::vector<Side> sides = sidesOf(mesh);
  Sets fans(3 * mesh.triangles.size()), loops(3 * mesh.triangles.size());
  std::vector<Side> border;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    if (end == i + 1) border.push_back(sides[i]);
    for (std::size_t j = i + 1; j < end; ++j) {
      fans.join(sides[i].at_low, sides[j].at_low);
      fans.join(sides[i].at_high, sides[j].at_high);
    }
    i = end;
  }
  for (const Side& side : border) loops.join(fans.of(side.at_low), fans.of(side.at_high));
  std::vector<std::size_t> ends;
  for (const Side& side : border) ends.push_back(loops.of(fans.of(side.at_low)));
  std::sort(ends.begin(), ends.end());
  return static_cast<std::size_t>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

std::size_t countFlatTriangles(const TriangleMesh& mesh) {
  constexpr double kFlat = 1e-6;
  std::size_t count = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double longest =
        std::max({length(subtract(b, a)), length(subtract(c, b)), length(subtract(a, c))});
    count += length(cross(subtract(b, a), subtract(c, a))) <= kFlat * longest * longest ? 1 : 0;
  }
  return count;
}

FarPlaces farPlaces(const TriangleMesh& mesh, const rivals::PointTree& tree,
                    const std::vector<Vector3>& points, double limit) {
  FarPlaces far;
  forParts(mesh, 1.5, [&](const std::array<Vector3, 3>& part) {
    const Vector3 middle = middleOf(part);
    const double distance = length(subtract(middle, points[tree.nearest(middle, 1).front()]));
    far.farthest = std::max(far.farthest, distance);
    if (distance > limit) far.area += areaOf(part);
  });
  return far;
}

}  // namespace pcl_slim::borders

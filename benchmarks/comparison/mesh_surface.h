// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_slim::comparison {

/** \brief The nearest place on a mesh. */
struct MeshFoot {
  double distance = 0;
  bool border = false;  ///< the foot is on an edge of only one triangle
};

/** \brief The surface of a triangle mesh, for exact distances from points to it.
 *
 * The triangles are stored in a tree of boxes; a query takes O(log triangles) near the surface.
 */
class MeshSurface {
 public:
  using Point = std::array<double, 3>;
  using Triangle = std::array<std::uint32_t, 3>;

  /** \brief At least one triangle; corners are indices of finite vertices. */
  MeshSurface(std::vector<Point> vertices, std::vector<Triangle> triangles);

  MeshFoot nearest(const Point& p) const;

 private:
  struct Node {
    Point low, high;
    std::uint32_t begin = 0, end = 0;  ///< triangles; inner nodes have their children at first
    std::uint32_t first = 0;           ///< 0: a leaf
  };

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end);
  void findBorders();
  void visit(const Triangle& triangle, std::uint8_t borders, const Point& p, double& best_sq,
             bool& border) const;

  std::vector<Point> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint8_t> borders_;  ///< bit k: edge k to k + 1 is on the border; 3 + k: corner k
  std::vector<Node> nodes_;
};

}  // namespace pcl_slim::comparison

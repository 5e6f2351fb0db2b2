// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "borders/mesh_parts.h"
#include "borders/reconstructions.h"
#include "reconstruction/rivals.h"
#include "rivals/point_tree.h"

namespace pcl_slim::borders {

Error trimmedPoisson(const OpenScene& scene, double trim, TriangleMesh& mesh) {
  constexpr double kWidened = 1.1;  ///< the octree's box over that of the points
  measure::Scene input;
  input.normals = scene.normals;
  Bounds box;
  for (const Vector3& p : scene.points) {
    box.add(p);
    input.points.insert(input.points.end(), p.begin(), p.end());
  }
  double widest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) widest = std::max(widest, box.high[a] - box.low[a]);
  const int depth = static_cast<int>(std::ceil(std::log2(kWidened * widest)));
  TriangleMesh whole;
  if (Error error = reconstruction_bench::poisson(input, depth, whole)) return error;
  const rivals::PointTree tree(scene.points);
  mesh = whole;
  mesh.triangles.clear();
  for (const auto& t : whole.triangles) {
    const Vector3 middle =
        middleOf({whole.vertices[t[0]], whole.vertices[t[1]], whole.vertices[t[2]]});
    const Vector3& next = scene.points[tree.nearest(middle, 1).front()];
    if (length(subtract(next, middle)) <= trim) mesh.triangles.push_back(t);
  }
  return {};
}

}  // namespace pcl_slim::borders

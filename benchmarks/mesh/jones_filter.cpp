// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "mesh/rivals.h"

namespace pcl_slim::mesh_bench {

namespace {

/** What one filter pass reads: places and planes of faces, and how wide it looks. */
struct Pass {
  const MeshTopology& topology;
  Points centroids, normals;
  std::vector<double> areas;
  double spatial = 0;
  double range = 0;  ///< 0: faces predict their centroids, and heights do not count
};

double gaussian(double distance_sq, double sigma) {
  return std::exp(-0.5 * distance_sq / (sigma * sigma));
}

Vector3 filtered(const Pass& pass, const Vector3& p, const std::vector<std::uint32_t>& near) {
  Vector3 sum{};
  double total = 0;
  for (const std::uint32_t f : near) {
    const Vector3 step = subtract(pass.centroids[f], p);
    double weight = pass.areas[f] * gaussian(dot(step, step), pass.spatial);
    Vector3 predicted = pass.centroids[f];
    if (pass.range > 0) {
      const double height = dot(step, pass.normals[f]);
      predicted = along(p, height, pass.normals[f]);
      weight *= gaussian(height * height, pass.range);
    }
    sum = along(sum, weight, predicted);
    total += weight;
  }
  return total > 0 ? scaled(sum, 1 / total) : p;
}

Points runPass(const Pass& pass, const Points& vertices) {
  Points made = vertices;
  std::vector<std::uint32_t> seen(pass.centroids.size(), 0), near, all;
  std::uint32_t stamp = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const IndexRow own = pass.topology.facesOf(v);
    if (own.size() == 0) continue;
    // Beyond two deviations a face hardly counts.
    ++stamp;
    near.assign(own.begin(), own.end());
    for (const std::uint32_t f : near) seen[f] = stamp;
    for (std::size_t k = 0; k < near.size(); ++k) {
      for (const std::uint32_t g : pass.topology.around(near[k])) {
        if (seen[g] == stamp) continue;
        const Vector3 step = subtract(pass.centroids[g], vertices[v]);
        if (dot(step, step) > 4 * pass.spatial * pass.spatial) continue;
        seen[g] = stamp;
        near.push_back(g);
      }
    }
    made[v] = filtered(pass, vertices[v], near);
  }
  return made;
}

}  // namespace

Points jonesFilter(const Points& vertices, const MeshFaces& faces, const JonesParams& params) {
  const MeshTopology topology(faces, vertices.size());
  const double edge = meanEdge(vertices, faces);
  Pass pass{topology,
            faceCentroids(vertices, faces),
            {},
            faceAreas(vertices, faces),
            params.spatial * edge / 2,
            0};
  const Points mollified = runPass(pass, vertices);
  pass.normals = faceNormals(mollified, faces);
  pass.spatial = params.spatial * edge;
  pass.range = params.range * edge;
  return runPass(pass, vertices);
}

}  // namespace pcl_slim::mesh_bench

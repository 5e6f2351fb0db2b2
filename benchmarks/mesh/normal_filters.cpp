// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "mesh/rivals.h"

namespace pcl_slim::mesh_bench {

namespace {

double gaussian(const Vector3& difference, double sigma) {
  return std::exp(-0.5 * dot(difference, difference) / (sigma * sigma));
}

/** What the weights of a pass are made of. */
struct Weights {
  const Points& centroids;
  const Points& guidance;
  const std::vector<double>& areas;
  double spatial = 0, range = 0;
};

Vector3 meanNormal(const Weights& w, const Points& normals, std::uint32_t f,
                   const std::uint32_t* first, const std::uint32_t* last) {
  Vector3 sum{};
  for (const std::uint32_t* g = first; g != last; ++g) {
    const double weight = w.areas[*g] *
                          gaussian(subtract(w.centroids[f], w.centroids[*g]), w.spatial) *
                          gaussian(subtract(w.guidance[f], w.guidance[*g]), w.range);
    sum = along(sum, weight, normals[*g]);
  }
  return dot(sum, sum) > 0 ? normalized(sum) : normals[f];
}

/** A face with those around it. */
std::vector<std::uint32_t> patchOf(const MeshTopology& topology, std::uint32_t f) {
  const IndexRow ring = topology.around(f);
  std::vector<std::uint32_t> patch(ring.begin(), ring.end());
  patch.insert(std::lower_bound(patch.begin(), patch.end(), f), f);
  return patch;
}

/** How little the normals of a patch agree: their widest difference, times how much its strongest
 * edge stands out among its edges. */
double inconsistency(const Points& normals, const MeshTopology& topology,
                     const std::vector<std::uint32_t>& patch) {
  double widest = 0, strongest = 0, sum = 0;
  for (const std::uint32_t f : patch) {
    for (const std::uint32_t g : patch) {
      if (g <= f) continue;
      widest = std::max(widest, length(subtract(normals[f], normals[g])));
    }
    for (const std::uint32_t g : topology.acrossEdges(f)) {
      if (g <= f || !std::binary_search(patch.begin(), patch.end(), g)) continue;
      const double step = length(subtract(normals[f], normals[g]));
      strongest = std::max(strongest, step);
      sum += step;
    }
  }
  constexpr double kTiny = 1e-9;
  return widest * strongest / (sum + kTiny);
}

Points guidanceOf(const Points& normals, const std::vector<double>& areas,
                  const MeshTopology& topology) {
  std::vector<double> value(normals.size());
  Points mean(normals.size());
  for (std::uint32_t f = 0; f < normals.size(); ++f) {
    const auto patch = patchOf(topology, f);
    value[f] = inconsistency(normals, topology, patch);
    for (const std::uint32_t g : patch) mean[f] = along(mean[f], areas[g], normals[g]);
    mean[f] = normalized(mean[f]);
  }
  Points guidance(normals.size());
  for (std::uint32_t f = 0; f < normals.size(); ++f) {
    std::uint32_t best = f;
    for (const std::uint32_t g : topology.around(f)) {
      if (value[g] < value[best]) best = g;
    }
    guidance[f] = mean[best];
  }
  return guidance;
}

}  // namespace

void followNormals(const Points& normals, const MeshFaces& faces, const MeshTopology& topology,
                   int iterations, Points& vertices) {
  for (int i = 0; i < iterations; ++i) {
    const Points centroids = faceCentroids(vertices, faces);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const IndexRow own = topology.facesOf(v);
      Vector3 step{};
      for (const std::uint32_t f : own) {
        const double height = dot(normals[f], subtract(centroids[f], vertices[v]));
        step = along(step, height / static_cast<double>(own.size()), normals[f]);
      }
      vertices[v] = along(vertices[v], 1, step);
    }
  }
}

void facesWithin(const Points& centroids, const MeshTopology& topology, std::uint32_t f,
                 double reach, std::vector<std::uint32_t>& seen,
                 std::vector<std::uint32_t>& found) {
  found.assign(1, f);
  seen[f] = f + 1;
  for (std::size_t k = 0; k < found.size(); ++k) {
    for (const std::uint32_t g : topology.around(found[k])) {
      if (seen[g] == f + 1) continue;
      const Vector3 step = subtract(centroids[g], centroids[f]);
      if (dot(step, step) > reach * reach) continue;
      seen[g] = f + 1;
      found.push_back(g);
    }
  }
}

void bilateralNormalFilter(const Points& vertices, const MeshFaces& faces,
                           const NormalFilterParams& params, const Snapshot& tell) {
  const MeshTopology topology(faces, vertices.size());
  const Points centroids = faceCentroids(vertices, faces);
  const std::vector<double> areas = faceAreas(vertices, faces);
  const double spatial = meanCentroidDistance(centroids, topology);
  Points normals = faceNormals(vertices, faces);
  int done = 0;
  for (const int snapshot : params.snapshots) {
    for (; done < snapshot; ++done) {
      const Points before = normals;
      const Weights weights{centroids, before, areas, spatial, params.range};
      for (std::uint32_t f = 0; f < normals.size(); ++f) {
        const auto patch = patchOf(topology, f);
        normals[f] = meanNormal(weights, before, f, patch.data(), patch.data() + patch.size());
      }
    }
    Points made = vertices;
    followNormals(normals, faces, topology, params.vertex_iterations, made);
    tell(done, made);
  }
}

void guidedNormalFilter(const Points& vertices, const MeshFaces& faces,
                        const NormalFilterParams& params, const Snapshot& tell) {
  const MeshTopology topology(faces, vertices.size());
  Points made = vertices;
  std::vector<std::uint32_t> near;
  int done = 0;
  for (const int snapshot : params.snapshots) {
    for (; done < snapshot; ++done) {
      const Points centroids = faceCentroids(made, faces);
      const std::vector<double> areas = faceAreas(made, faces);
      const double spatial = meanCentroidDistance(centroids, topology);
      const Points before = faceNormals(made, faces);
      const Points guidance = guidanceOf(before, areas, topology);
      const Weights weights{centroids, guidance, areas, spatial, params.range};
      Points normals(before.size());
      std::vector<std::uint32_t> seen(before.size(), 0);
      for (std::uint32_t f = 0; f < normals.size(); ++f) {
        facesWithin(centroids, topology, f, 2 * spatial, seen, near);
        normals[f] = meanNormal(weights, before, f, near.data(), near.data() + near.size());
      }
      followNormals(normals, faces, topology, params.vertex_iterations, made);
    }
    tell(done, made);
  }
}

}  // namespace pcl_slim::mesh_bench

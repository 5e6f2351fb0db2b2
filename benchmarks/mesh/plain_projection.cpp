// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/rivals.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim::mesh_bench {

namespace {

/** Sums of the faces' area vectors around each vertex: the fit wants no unit ones. */
std::vector<float> vertexNormals(const Points& vertices, const MeshFaces& faces) {
  Points sums(vertices.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vector3 area = areaVector(vertices, faces[f]);
    for (const std::uint32_t v : faces[f]) sums[v] = along(sums[v], 1, area);
  }
  std::vector<float> normals;
  for (const Vector3& sum : sums) {
    for (const double value : normalized(sum)) normals.push_back(static_cast<float>(value));
  }
  return normals;
}

}  // namespace

Error plainProjection(const Points& vertices, const MeshFaces& faces, bool sharp, int threads,
                      Points& made) {
  const std::vector<float> normals = vertexNormals(vertices, faces);
  CloudView view;
  view.xyz = vertices.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = vertices.size();
  view.normal = normals.data();
  view.normal_stride = 3 * sizeof(float);
  const auto store = PointStore::build(view, threads);
  if (!store) return store.error();
  FitParams fit;
  fit.trim = false;
  fit.threads = threads;
  fit.sharp_features = sharp;
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fit, surface)) return error;
  ProjectionParams how;
  how.sharp_features = sharp;
  how.threads = threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, how, projection)) return error;
  made = vertices;
  const auto stored = store->storeOfInput();
  for (std::size_t v = 0; v < made.size(); ++v) {
    if (stored[v] == PointStore::kSkipped || projection.supported[stored[v]] == 0) continue;
    made[v] = along(store->origin(), store->scale(), projection.position[stored[v]]);
  }
  return {};
}

}  // namespace pcl_slim::mesh_bench

// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing/face_projection.h"

#include "pcl_slim/query/projection.h"

namespace pcl_slim::detail {

namespace {

/** Places and directions as the store wants them; the view is valid while this object lives. */
class Samples {
 public:
  Samples(const std::vector<Vector3>& places, const std::vector<Vector3>& normals)
  {
    normals_.reserve(3 * normals.size());
    for (const Vector3& n : normals) {
      for (const double value : n) normals_.push_back(static_cast<float>(value));
    }
    view_.xyz = places.data();
    view_.xyz_stride = sizeof(Vector3);
    view_.scalar = CloudView::Scalar::kDouble;
    view_.normal = normals_.data();
    view_.normal_stride = 3 * sizeof(float);
    view_.size = places.size();
  }

  const CloudView& view() const { return view_; }

 private:
  std::vector<float> normals_;
  CloudView view_;
};

}  // namespace

Error
fitToVertices(const std::vector<Vector3>& vertices, const std::vector<Vector3>& normals,
              const FitParams& params, SLIMSurface& surface, FitStatistics& statistics,
              Progress* progress)
{
  const Samples samples(vertices, normals);
  const auto store = PointStore::build(samples.view(), params.threads);
  if (!store) return store.error();
  return fitSurface(*store, params, surface, &statistics, progress);
}

Error
projectFaces(const std::vector<Vector3>& centroids, const std::vector<Vector3>& normals,
             const SLIMSurface& surface, const FitParams& params, FaceProjection& made,
             Progress* progress)
{
  made.places = centroids;
  made.normals.assign(centroids.size(), Vector3{});
  made.unsupported = centroids.size();
  const Samples samples(centroids, normals);
  const auto store = PointStore::build(samples.view(), params.threads);
  if (!store) return store.error();
  ProjectionParams how;
  how.sharp_features = params.sharp_features;
  how.paper_mode = surface.info.paper_mode;
  how.threads = params.threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, how, projection, progress)) return error;
  const std::vector<std::uint32_t> stored = store->storeOfInput();
  for (std::size_t f = 0; f < stored.size(); ++f) {
    if (stored[f] == PointStore::kSkipped || projection.supported[stored[f]] == 0) continue;
    const auto& place = projection.position[stored[f]];
    const auto& normal = projection.normal[stored[f]];
    const Vector3 n = {normal[0], normal[1], normal[2]};
    made.normals[f] = dot(n, normals[f]) < 0 ? scaled(n, -1) : n;
    made.places[f] = along(store->origin(), store->scale(), place);
    --made.unsupported;
  }
  return {};
}

}  // namespace pcl_slim::detail

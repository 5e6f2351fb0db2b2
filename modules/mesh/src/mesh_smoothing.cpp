// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "smoothing/face_geometry.h"
#include "smoothing/face_projection.h"
#include "smoothing/normal_filter.h"
#include "smoothing/vertex_update.h"

#include <cstdlib>
namespace pcl_slim {

namespace {
double P(const char* n, double d) { const char* v = std::getenv(n); return v ? std::atof(v) : d; }

using detail::FaceGeometry;
using detail::FaceProjection;

std::vector<Vector3>
positionsOf(const CloudView& cloud)
{
  std::vector<Vector3> made(cloud.size);
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto* at = static_cast<const unsigned char*>(cloud.xyz) + i * cloud.xyz_stride;
    if (cloud.scalar == CloudView::Scalar::kDouble) {
      std::memcpy(made[i].data(), at, sizeof(Vector3));
      continue;
    }
    float p[3];
    std::memcpy(p, at, sizeof(p));
    made[i] = {p[0], p[1], p[2]};
  }
  return made;
}

bool
isFinite(const Vector3& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/** Faces of three finite corners or more, and which they are of those given. */
struct UsedFaces {
  MeshFaces faces;
  std::vector<std::uint32_t> given;
};

UsedFaces
usedFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces)
{
  UsedFaces used;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    const bool finite = std::all_of(corners.begin(), corners.end(),
                                    [&](std::uint32_t v) { return isFinite(vertices[v]); });
    if (corners.size() < 3 || !finite) continue;
    used.faces.add(corners.begin(), corners.size());
    used.given.push_back(static_cast<std::uint32_t>(f));
  }
  return used;
}

Error
cancelled(Progress* progress)
{
  if (progress == nullptr || !progress->cancelled()) return {};
  return {ErrorCode::kCancelled, "the smoothing was cancelled"};
}

/** One run, from noisy vertices to smooth ones. */
class Smoothing {
 public:
  Smoothing(const MeshFaces& faces, std::vector<Vector3> vertices, const MeshSmoothParams& params,
            const SLIMSurface* surface, MeshSmoothStatistics& statistics, Progress* progress)
      : faces_(faces),
        noisy_(std::move(vertices)),
        params_(params),
        surface_(surface),
        statistics_(statistics),
        progress_(progress),
        topology_(faces_, noisy_.size()),
        moved_(noisy_),
        held_(noisy_.size())
  {
    geometry_ = detail::measureFaces(noisy_, faces_, params.fit.threads);
  }

  Error run()
  {
    params_.fit.sharp_features = params_.edges == MeshEdges::kSharp;
    if (params_.fit.paper_mode) return runAsPaper();
    if (params_.edges != MeshEdges::kRounded) {
      if (Error error = runSharp()) return error;
      statistics_.sharp_share = detail::sharpShare(normals_, topology_);
      statistics_.sharp = true;
      if (params_.edges == MeshEdges::kSharp || statistics_.sharp_share > P("SHARE", 0.5)) return {};
    }
    return runRounded();
  }

  const std::vector<Vector3>& vertices() const { return moved_; }
  const std::vector<Vector3>& normals() const { return normals_; }
  const std::vector<std::uint8_t>& held() const { return held_; }
  const SLIMSurface& fitted() const { return fitted_; }

 private:
  /** Fits to the noisy vertices, with normals of faces as they are known now, and projects the moved
   * mesh's faces. */
  Error project(const std::vector<Vector3>& normals, FaceProjection& made)
  {
    if (surface_ == nullptr) {
      const auto vertex_normals = detail::vertexNormals(geometry_, normals, topology_,
                                                        noisy_.size(), params_.fit.threads);
      Error error = detail::fitToVertices(noisy_, vertex_normals, params_.fit, fitted_,
                                          statistics_.fit, progress_);
      if (error) return error;
    }
    const SLIMSurface& surface = surface_ ? *surface_ : fitted_;
    const FaceGeometry now = detail::measureFaces(moved_, faces_, params_.fit.threads);
    Error error =
        detail::projectFaces(now.centroids, normals, surface, params_.fit, made, progress_);
    statistics_.faces_unsupported = made.unsupported;
    statistics_.noise = std::sqrt(surface.info.lambda) * surface.info.diagonal *
                        surface.info.scale / detail::meanEdgeLength(noisy_, faces_);
    return error;
  }

  detail::MovingMesh moving()
  {
    return {faces_, topology_, moved_, held_, params_.fit.threads};
  }

  Error runAsPaper()
  {
    FaceProjection made;
    if (Error error = project(geometry_.normals, made)) return error;
    normals_ = made.normals;
    constexpr double kRegularity = 0.01;
    for (std::size_t f = 0; f < normals_.size(); ++f) {
      if (normals_[f] == Vector3{}) normals_[f] = geometry_.normals[f];
    }
    detail::minimiseQuadrics(made.places, normals_, geometry_.areas, kRegularity, moving());
    return {};
  }

  Error runRounded()
  {
    params_.fit.sharp_features = false;
    statistics_.sharp = false;
    moved_ = noisy_;
    std::fill(held_.begin(), held_.end(), 0);
    FaceProjection made;
    if (Error error = project(geometry_.normals, made)) return error;
    normals_ = geometry_.normals;
    const double tau = std::max(statistics_.noise, 1e-6);
    const double pull = P("PULL", .1) * std::pow(P("TAU", .2) / tau, 2);
    const detail::NormalFilter filter{geometry_, topology_, P("RANGE", .7), params_.fit.threads};
    for (int i = 0; i < P("ITER", 4); ++i) {
      normals_ = detail::filterNormals(filter, normals_, normals_);
      detail::pullNormals(made.normals, pull, normals_);
    }
    detail::followNormals(normals_, static_cast<int>(P("STEPS", 10)), moving());
    return {};
  }

  Error runSharp()
  {
    params_.fit.sharp_features = true;
    detail::NormalFilter filter{geometry_, topology_, P("PRERANGE", .5), params_.fit.threads};
    normals_ = geometry_.normals;
    for (int i = 0; i < P("PRE", 5); ++i) normals_ = detail::filterNormals(filter, normals_, normals_);
    const int rounds = static_cast<int>(P("ROUNDS", 4));
    for (int round = 0; round < rounds; ++round) {
      if (progress_) progress_->report(static_cast<float>(round) / 5.0f, "smoothing");
      if (Error error = cancelled(progress_)) return error;
      FaceProjection made;
      if (Error error = project(normals_, made)) return error;
      const FaceGeometry now = detail::measureFaces(moved_, faces_, params_.fit.threads);
      for (std::size_t f = 0; f < now.normals.size(); ++f) {
        if (made.normals[f] == Vector3{}) made.normals[f] = normals_[f];
      }
      const detail::NormalFilter sharp{now, topology_, P("SRANGE", .15), params_.fit.threads};
      normals_ = detail::filterNormals(sharp, made.normals, now.normals);
      for (int i = 1; i < P("SITER", 6); ++i) normals_ = detail::filterNormals(sharp, normals_, normals_);
      moved_ = noisy_;
      std::fill(held_.begin(), held_.end(), 0);
      detail::followNormals(normals_, static_cast<int>(P("SSTEPS", 20)), moving());
    }
    return {};
  }

  const MeshFaces& faces_;
  const std::vector<Vector3> noisy_;
  MeshSmoothParams params_;
  const SLIMSurface* surface_;
  MeshSmoothStatistics& statistics_;
  Progress* progress_;
  MeshTopology topology_;
  FaceGeometry geometry_;  ///< of the noisy mesh
  std::vector<Vector3> moved_, normals_;
  std::vector<std::uint8_t> held_;
  SLIMSurface fitted_;
};

}  // namespace

Error
smoothMesh(const CloudView& cloud, const MeshFaces& faces, const MeshSmoothParams& params,
           const SLIMSurface* surface, SmoothedMesh& result, MeshSmoothStatistics* statistics,
           SLIMSurface* fitted, Progress* progress)
{
  MeshSmoothStatistics own;
  MeshSmoothStatistics& s = statistics ? *statistics : own;
  s = {};
  result = {};
  std::vector<Vector3> vertices = positionsOf(cloud);
  UsedFaces used = usedFaces(vertices, faces);
  Smoothing smoothing(used.faces, vertices, params, surface, s, progress);
  if (Error error = smoothing.run()) return error;
  result.vertices = smoothing.vertices();
  result.face_normals.assign(faces.size(), Vector3{});
  for (std::size_t f = 0; f < used.given.size(); ++f) {
    result.face_normals[used.given[f]] = smoothing.normals()[f];
  }
  for (auto h : smoothing.held()) s.held += h;
  if (fitted) *fitted = smoothing.fitted();
  return {};
}

}  // namespace pcl_slim

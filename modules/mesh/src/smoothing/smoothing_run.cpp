// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing/smoothing_run.h"

#include <algorithm>
#include <cmath>

#include "smoothing/normal_filter.h"

namespace pcl_slim::detail {

namespace {

// Deviations over differences of unit normals: where there are no edges, only faces that turn from
// each other by 40 degrees and more count little; across edges, those that do by 10.
constexpr double kRoundedRange = 0.7, kFirstRange = 0.5, kSharpRange = 0.15;
constexpr int kRoundedPasses = 4, kFirstPasses = 8, kSharpPasses = 8, kSharpRounds = 4;
constexpr int kRoundedSteps = 10, kSharpSteps = 20, kUnfoldSteps = 5;
/** Weight of the surface's normals beside the mesh's own, at noise of a fifth of an edge. Noise of
 * normals grows with that of vertices, and weights go by variances. */
constexpr double kPull = 0.1, kPullNoise = 0.2;
/** Least share of the bending in sharp edges for a mesh that has edges. Machine parts have .70 to .84
 * after the first round, scans of bodies .21 to .56. */
constexpr double kSharpShare = 0.63;
/** Beside planes of weight 1: keeps vertices from running along what planes leave open. */
constexpr double kPaperRegularity = 0.01;

}  // namespace

SmoothingRun::SmoothingRun(const MeshFaces& faces, const std::vector<Vector3>& vertices,
                           const MeshSmoothParams& params, const SLIMSurface* surface,
                           MeshSmoothStatistics& statistics, Progress* progress)
    : faces_(faces),
      given_(vertices),
      params_(params),
      surface_(surface),
      statistics_(statistics),
      progress_(progress),
      topology_(faces, vertices.size()),
      geometry_(measureFaces(vertices, faces, params.fit.threads)),
      moved_(vertices),
      normals_(geometry_.normals),
      held_(vertices.size())
{
}

Error
SmoothingRun::run()
{
  params_.fit.sharp_features = params_.edges == MeshEdges::kSharp;
  if (params_.fit.paper_mode) return runAsPaper();
  if (params_.edges == MeshEdges::kRounded) return runRounded();
  if (Error error = runSharp()) return error;
  return statistics_.sharp ? Error() : runRounded();
}

MovingMesh
SmoothingRun::moving()
{
  return {faces_, topology_, moved_, held_, params_.fit.threads};
}

std::vector<Vector3>
SmoothingRun::vertexNormals() const
{
  return detail::vertexNormals(facesNow(), normals_, topology_, moved_.size(), params_.fit.threads);
}

FaceGeometry
SmoothingRun::facesNow() const
{
  return measureFaces(moved_, faces_, params_.fit.threads);
}

Error
SmoothingRun::project(const std::vector<Vector3>& normals, FaceProjection& made)
{
  if (surface_ == nullptr) {
    const auto sides =
        detail::vertexNormals(geometry_, normals, topology_, given_.size(), params_.fit.threads);
    Error error = fitToVertices(given_, sides, params_.fit, fitted_, statistics_.fit, progress_);
    if (error) return error;
  }
  const SLIMSurface& surface = surface_ != nullptr ? *surface_ : fitted_;
  Error error = projectFaces(facesNow().centroids, normals, surface, params_.fit, made, progress_);
  statistics_.faces_unsupported = made.unsupported;
  const double edge = meanEdgeLength(given_, faces_);
  const SurfaceInfo& info = surface.info;
  statistics_.noise = edge > 0 ? std::sqrt(info.lambda) * info.diagonal * info.scale / edge : 0;
  // Where there is no surface, the face's own normal is all that is known.
  for (std::size_t f = 0; f < made.normals.size(); ++f) {
    if (made.normals[f] == Vector3{}) made.normals[f] = normals[f];
  }
  return error;
}

void
SmoothingRun::moveVertices(int steps)
{
  moved_ = given_;
  std::fill(held_.begin(), held_.end(), 0);
  unfold(normals_, kUnfoldSteps, moving());
  followNormals(normals_, steps, moving());
}

Error
SmoothingRun::runAsPaper()
{
  FaceProjection made;
  if (Error error = project(geometry_.normals, made)) return error;
  normals_ = made.normals;
  minimiseQuadrics(made.places, normals_, geometry_.areas, kPaperRegularity, moving());
  return {};
}

Error
SmoothingRun::runRounded()
{
  params_.fit.sharp_features = false;
  moved_ = given_;
  normals_ = geometry_.normals;
  FaceProjection made;
  if (Error error = project(normals_, made)) return error;
  constexpr double kLeastNoise = 1e-3;
  const double pull = kPull * std::pow(kPullNoise / std::max(statistics_.noise, kLeastNoise), 2);
  const NormalFilter filter{geometry_, topology_, kRoundedRange, params_.fit.threads};
  for (int i = 0; i < kRoundedPasses; ++i) {
    normals_ = filterNormals(filter, normals_, normals_);
    pullNormals(made.normals, pull, normals_);
  }
  mendLoneNormals(filter, normals_);
  moveVertices(kRoundedSteps);
  unfold(ringNormals(filter, normals_), kUnfoldSteps, moving());
  return {};
}

Error
SmoothingRun::runSharp()
{
  params_.fit.sharp_features = true;
  const NormalFilter first{geometry_, topology_, kFirstRange, params_.fit.threads};
  for (int i = 0; i < kFirstPasses; ++i) normals_ = filterNormals(first, normals_, normals_);
  for (int round = 0; round < kSharpRounds; ++round) {
    if (Error error = sharpRound()) return error;
    if (round == 0 && !hasSharpEdges()) return {};
  }
  unfold(ringNormals(first, normals_), kUnfoldSteps, moving());
  return {};
}

bool
SmoothingRun::hasSharpEdges()
{
  statistics_.sharp_share = sharpShare(normals_, topology_);
  statistics_.sharp = params_.edges == MeshEdges::kSharp || statistics_.sharp_share > kSharpShare;
  return statistics_.sharp;
}

Error
SmoothingRun::sharpRound()
{
  FaceProjection made;
  if (Error error = project(normals_, made)) return error;
  const FaceGeometry now = facesNow();
  const NormalFilter filter{now, topology_, kSharpRange, params_.fit.threads};
  normals_ = filterNormals(filter, made.normals, now.normals);
  for (int i = 1; i < kSharpPasses; ++i) normals_ = filterNormals(filter, normals_, normals_);
  mendLoneNormals(filter, normals_);
  moveVertices(kSharpSteps);
  return {};
}

}  // namespace pcl_slim::detail

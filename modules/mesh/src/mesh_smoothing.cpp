// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/surface/surface.h"
#include "smoothing_steps.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief The projections of faces onto a surface. */
struct FaceProjection {
  std::vector<Vector3> places;   ///< projected centroids; as given where unsupported
  std::vector<Vector3> normals;  ///< eq. 7, to the side given; zero where unsupported
  std::uint64_t unsupported = 0;
};

/** Places and directions in the layout of the store; the view is valid while this object lives. */
class Samples {
 public:
  Samples(const std::vector<Vector3>& places, const std::vector<Vector3>& normals) {
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

/** \brief Projects the faces' centroids onto a surface. */
Error projectFaces(const std::vector<Vector3>& centroids, const std::vector<Vector3>& normals,
                   const SLIMSurface& surface, const FitParams& params, FaceProjection& made,
                   Progress* progress) {
  made.places = centroids;
  made.normals.assign(centroids.size(), Vector3{});
  made.unsupported = centroids.size();
  const Samples samples(centroids, normals);
  const auto store = PointStore::build(samples.view(), params.threads);
  if (!store) return store.error();
  ProjectionParams how;
  how.sharp_features = params.sharp_features;
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

/** \brief One smoothing of a mesh whose faces are all usable. */
class SmoothingRun {
 public:
  /** \brief Faces must outlive this object. \param[in] surface in place of a fit, or null. */
  SmoothingRun(const MeshFaces& faces, const std::vector<Vector3>& vertices,
               const MeshSmoothParams& params, const SLIMSurface* surface,
               MeshSmoothStatistics& statistics, Progress* progress);

  Error run();

  const std::vector<Vector3>& vertices() const { return moved_; }
  const std::vector<Vector3>& normals() const { return normals_; }
  /** \brief Of the smooth mesh, at its vertices. */
  std::vector<Vector3> vertexNormals() const;
  const std::vector<std::uint8_t>& held() const { return held_; }
  SLIMSurface takeFitted() { return std::move(fitted_); }

 private:
  /** \brief As in the paper: one projection, one step of the vertices. */
  Error runAsPaper();
  /** \brief Smooth everywhere: the mesh's normals, weighed against the surface's. */
  Error runRounded();
  /** \brief Edges kept: the mesh's normals, averaged as far as the surface's agree. Only as far as
   * needed to see that there are no edges to keep, where the caller wants to know. */
  Error runSharp();

  /** \brief One round of runSharp(). */
  Error sharpRound();
  /** \brief Whether the normals found are those of a mesh with edges. */
  bool hasSharpEdges();
  /** \brief Fits to the vertices as given, with normals from those of the faces, and projects the
   * centroids of the faces as they are now. */
  Error project(const std::vector<Vector3>& normals, FaceProjection& made);
  /** \brief Puts all vertices back and moves them towards the normals. */
  void moveVertices(int steps);

  MovingMesh moving();
  FaceGeometry facesNow() const;

  const MeshFaces& faces_;
  const std::vector<Vector3>& given_;
  MeshSmoothParams params_;
  const SLIMSurface* surface_;
  MeshSmoothStatistics& statistics_;
  Progress* progress_;
  MeshTopology topology_;
  FaceGeometry geometry_;  ///< of the mesh as given
  std::vector<Vector3> moved_, normals_;
  std::vector<std::uint8_t> held_;
  SLIMSurface fitted_;
};

// Deviations over differences of unit normals: where there are no edges, only faces that turn from
// each other by 40 degrees and more count little; across edges, those that do by 10.
constexpr double kRoundedRange = 0.7, kFirstRange = 0.5, kSharpRange = 0.15;
constexpr int kRoundedPasses = 4, kFirstPasses = 8, kSharpPasses = 8, kSharpRounds = 4;
constexpr int kRoundedSteps = 10, kSharpSteps = 20, kUnfoldSteps = 5;
/** Weight of the surface's normals relative to the mesh's own, at noise of a fifth of an edge.
 * Noise of normals grows with that of vertices, and weights go by variances. */
constexpr double kPull = 0.1, kPullNoise = 0.2;
/** Least share of the bending in sharp edges for a mesh that has edges. Machine parts have .70 to
 * .84 after the first round, scans of bodies .21 to .56. */
constexpr double kSharpShare = 0.63;
/** Relative to planes of weight 1: keeps vertices from drifting where planes do not fix them. */
constexpr double kPaperRegularity = 0.01;

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
      held_(vertices.size()) {}

Error SmoothingRun::run() {
  params_.fit.sharp_features = params_.edges == MeshEdges::kSharp;
  if (params_.fit.paper_mode) return runAsPaper();
  if (params_.edges == MeshEdges::kRounded) return runRounded();
  if (Error error = runSharp()) return error;
  return statistics_.sharp ? Error() : runRounded();
}

MovingMesh SmoothingRun::moving() {
  return {faces_, topology_, moved_, held_, params_.fit.threads};
}

std::vector<Vector3> SmoothingRun::vertexNormals() const {
  return detail::vertexNormals(facesNow(), normals_, topology_, moved_.size(), params_.fit.threads);
}

FaceGeometry SmoothingRun::facesNow() const {
  return measureFaces(moved_, faces_, params_.fit.threads);
}

Error SmoothingRun::project(const std::vector<Vector3>& normals, FaceProjection& made) {
  if (surface_ == nullptr) {
    const auto sides =
        detail::vertexNormals(geometry_, normals, topology_, given_.size(), params_.fit.threads);
    FittedScan scan;
    // Vertices whose normal is zero are left out.
    Error error = fitScan({Samples(given_, sides).view(), {}}, params_.fit, scan, progress_);
    statistics_.fit = std::move(scan.statistics);
    if (error) return error;
    fitted_ = std::move(scan.surface);
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

void SmoothingRun::moveVertices(int steps) {
  moved_ = given_;
  std::fill(held_.begin(), held_.end(), 0);
  unfold(normals_, kUnfoldSteps, moving());
  followNormals(normals_, steps, moving());
}

Error SmoothingRun::runAsPaper() {
  FaceProjection made;
  if (Error error = project(geometry_.normals, made)) return error;
  normals_ = made.normals;
  minimiseQuadrics(made.places, normals_, geometry_.areas, kPaperRegularity, moving());
  return {};
}

Error SmoothingRun::runRounded() {
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

Error SmoothingRun::runSharp() {
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

bool SmoothingRun::hasSharpEdges() {
  statistics_.sharp_share = sharpShare(normals_, topology_);
  statistics_.sharp = params_.edges == MeshEdges::kSharp || statistics_.sharp_share > kSharpShare;
  return statistics_.sharp;
}

Error SmoothingRun::sharpRound() {
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

std::vector<Vector3> positionsOf(const CloudView& cloud) {
  std::vector<Vector3> made(cloud.size);
  for (std::size_t i = 0; i < made.size(); ++i) made[i] = cloud.position(i);
  return made;
}

bool isUsable(const std::vector<Vector3>& vertices, IndexRow corners) {
  if (corners.size() < 3) return false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!isFinite(vertices[corners[k]])) return false;
    if (std::find(corners.begin(), corners.begin() + k, corners[k]) != corners.begin() + k) {
      return false;
    }
  }
  return true;
}

/** Faces that can be used, and which they are of those given. */
struct UsedFaces {
  MeshFaces faces;
  std::vector<std::uint32_t> given;
};

UsedFaces usedFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces) {
  UsedFaces used;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!isUsable(vertices, faces[f])) continue;
    used.faces.add(faces[f].begin(), faces[f].size());
    used.given.push_back(static_cast<std::uint32_t>(f));
  }
  return used;
}

Error checkInput(const CloudView& cloud, const MeshFaces& faces, const MeshSmoothParams& params,
                 const SLIMSurface* surface) {
  if (Error error = params.validate()) return error;
  if (cloud.size == 0) return {ErrorCode::kBadInput, "the mesh has no vertices; give one that has"};
  if (Error error = cloud.validate()) return error;
  if (faces.size() == 0) {
    return {ErrorCode::kBadInput,
            "the mesh has no faces; smooth its points as a cloud, or give one that has"};
  }
  if (Error error = faces.validate(cloud.size)) return error;
  return surface != nullptr ? surface->validate() : Error();
}

/** Counts what became of the vertices. */
void countVertices(const std::vector<Vector3>& before, const SmoothedMesh& after,
                   const MeshFaces& used, MeshSmoothStatistics& s) {
  std::vector<std::uint8_t> named(before.size());
  for (const std::uint32_t v : used.corners) named[v] = 1;
  double sum = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (!isFinite(before[v])) {
      ++s.non_finite;
      continue;
    }
    if (named[v] == 0) ++s.isolated;
    if (after.vertices[v] == before[v]) continue;
    const double distance = length(subtract(after.vertices[v], before[v]));
    ++s.moved;
    sum += distance * distance;
    s.max_displacement = std::max(s.max_displacement, distance);
  }
  s.rms_displacement = s.moved > 0 ? std::sqrt(sum / static_cast<double>(s.moved)) : 0;
}

Error noUsableFace(std::size_t faces) {
  return {ErrorCode::kBadInput,
          "none of " + std::to_string(faces) +
              " faces has three different finite corners; give a mesh that has some"};
}

}  // namespace

Error smoothMesh(const CloudView& cloud, const MeshFaces& faces, const MeshSmoothParams& params,
                 const SLIMSurface* surface, SmoothedMesh& result, MeshSmoothStatistics* statistics,
                 SLIMSurface* fitted, Progress* progress) {
  MeshSmoothStatistics own;
  MeshSmoothStatistics& s = statistics != nullptr ? *statistics : own;
  s = {};
  result = {};
  if (fitted != nullptr) *fitted = {};
  if (Error error = checkInput(cloud, faces, params, surface)) return error;
  const std::vector<Vector3> vertices = positionsOf(cloud);
  const UsedFaces used = usedFaces(vertices, faces);
  s.faces = faces.size();
  s.faces_left_out = faces.size() - used.given.size();
  if (used.given.empty()) return noUsableFace(faces.size());
  countEdges(used.faces, s.disagreeing_edges, s.nonmanifold_edges);
  SmoothingRun run(used.faces, vertices, params, surface, s, progress);
  if (Error error = run.run()) return error;
  // Checked after the last progress report: a caller who cancels gets no result.
  if (progress != nullptr && progress->cancelled()) {
    return {ErrorCode::kCancelled, "the smoothing was cancelled"};
  }
  result.vertices = run.vertices();
  result.normals = run.vertexNormals();
  result.face_normals.assign(faces.size(), Vector3{});
  for (std::size_t f = 0; f < used.given.size(); ++f) {
    result.face_normals[used.given[f]] = run.normals()[f];
  }
  s.held = static_cast<std::uint64_t>(std::count(run.held().begin(), run.held().end(), 1));
  countVertices(vertices, result, used.faces, s);
  if (fitted != nullptr && surface == nullptr) *fitted = run.takeFitted();
  return {};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_reconstruction.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "finite_points.h"
#include "input_types.h"
#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/mesh_colors.h"
#include "pcl_slim/filters/pcl_normals.h"
#include "pcl_slim/filters/slim_reconstruction_base.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

namespace {

constexpr int kNearest = 4;

}  // namespace

Error colorFromPoints(const CloudView& cloud, const ColorView& colors, int threads,
                      TriangleMesh& mesh) {
  mesh.colors.clear();
  if (colors.bgr == nullptr) return badInput("the points have no colours; give a coloured scan");
  if (Error error = cloud.validate()) return error;
  const detail::FinitePoints nearby(cloud);
  if (nearby.source.empty()) return CloudView::nothingFinite();
  const pcl::search::Search<pcl::PointXYZ>::Ptr tree = makeSearch(nearby.points);
  const int k = std::min<int>(kNearest, static_cast<int>(nearby.source.size()));
  mesh.colors.resize(mesh.vertices.size());
  parallelFor(mesh.vertices.size(), resolveThreads(threads), 1024, [&](std::size_t v, int) {
    pcl::Indices found(static_cast<std::size_t>(k));
    std::vector<float> distances(static_cast<std::size_t>(k));
    const int count = tree->nearestKSearch(nearby.local(mesh.vertices[v]), k, found, distances);
    double sum[3] = {0, 0, 0}, weights = 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(count); ++j) {
      const std::size_t place = cloud.inputIndex(nearby.source[static_cast<std::size_t>(found[j])]);
      const auto* bgr = static_cast<const std::uint8_t*>(colors.bgr) + place * colors.stride;
      const double weight = 1 / (static_cast<double>(distances[j]) + 1e-30);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * bgr[2 - c];
      weights += weight;
    }
    for (std::size_t c = 0; c < 3 && weights > 0; ++c) {
      mesh.colors[v][c] = static_cast<std::uint8_t>(std::lround(sum[c] / weights));
    }
  });
  return {};
}

namespace {

constexpr double kLeastHole = 2;  ///< spacings that trim maps keep at least

}  // namespace

void SLIMReconstructionBase::clearMesh() {
  clearResults();
  mesh_.clear();
  mesh_statistics_ = {};
  fitted_surface_.reset();
}

std::vector<float> SLIMReconstructionBase::vertexVariation() const {
  CloudView view;
  view.xyz = mesh_.vertices.data();
  view.xyz_stride = sizeof(mesh_.vertices[0]);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = mesh_.vertices.size();
  std::vector<float> variation = surfaceVariation(view, params_.threads);
  for (float& value : variation)
    if (std::isnan(value)) value = 0.0f;
  return variation;
}

bool SLIMReconstructionBase::fitSurfaces(const CloudView& cloud, SLIMSurface& surface,
                                         SLIMSurface& sharp) {
  FitParams fit = params_;
  // Trim maps keep holes as small as the mesh is to have, unless the user chose which.
  if (mesh_params_.hole_size > 0 && fit.hole_size == FitParams().hole_size)
    fit.hole_size = std::clamp(mesh_params_.hole_size, kLeastHole, fit.hole_size);
  if (fit.sharp_features && cloud.normal != nullptr) {
    FitParams edges = fit;
    edges.trim = false;
    if (!run({cloud, {}}, edges, sharp)) return false;
    fit.sharp_features = false;
  }
  return run({cloud, {}}, fit, surface);
}

bool SLIMReconstructionBase::makeMesh(const ScanView& scan) {
  MeshParams params = mesh_params_;
  params.trim = params_.trim;
  params.threads = params_.threads;
  if (const Error error = params.validate()) return fail(error.code, error.message);
  const SurfaceConstPtr given = given_surface_;
  SurfaceConstPtr surface = given;
  SLIMSurface sharp;
  if (!surface) {
    auto fitted = std::make_shared<SLIMSurface>();
    if (!fitSurfaces(scan.points, *fitted, sharp)) return false;
    if (!sharp.empty()) params.sharp = &sharp;
    surface = fitted;
  }
  const CancellableRun cancellable(control_.progress);
  const bool done = guarded("the extraction", "raise the tolerance", [&]() -> Error {
    if (Error error = extractMesh(*surface, params, mesh_, &mesh_statistics_, &control_.progress)) {
      return error;
    }
    if (colors_ && scan.colors.bgr != nullptr)
      return colorFromPoints(scan.points, scan.colors, params.threads, mesh_);
    if (colors_)
      mesh_.colors = surfaceColors(*surface, mesh_.vertices, mesh_.normals, params.threads);
    return {};
  });
  if (!done) {
    mesh_.clear();
    return false;
  }
  if (!given) fitted_surface_ = surface;
  return true;
}

}  // namespace pcl_slim

// The class of all point types it is compiled for.
PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_SLIMReconstruction)

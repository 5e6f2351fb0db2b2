// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_curvature_estimation.hpp"

#include <optional>
#include <utility>

#include "input_types.h"
#include "pcl_slim/filters/slim_projection_base.h"

namespace pcl_slim {

void SLIMProjectionBase::clearResults() {
  SLIMFitBase::clearResults();
  fitted_surface_.reset();
  warning_.clear();
  projection_ = {};
  unsupported_.clear();
  outside_.clear();
}

bool SLIMProjectionBase::project(const CloudView& points, const CloudView& fitted,
                                 ProjectionParams params, CloudProjection& projection) {
  const CancellableRun cancellable(control_.progress);
  error_ = params_.validate();
  if (error_) return false;
  params.threads = params_.threads;
  const bool done = guarded("the projection", "process fewer points",
                            [&] { return fitAndProject(points, fitted, params, projection); });
  if (!done) {
    fitted_surface_.reset();
    warning_.clear();
    return false;
  }
  projection_ = projection.statistics();
  const auto unsupported = projection.unsupported();
  unsupported_.assign(unsupported.begin(), unsupported.end());
  const auto outside = projection.outside();
  outside_.assign(outside.begin(), outside.end());
  return true;
}

/** Fits; where points that are no surface may stay as they are, the surface of such is empty. */
Result<std::shared_ptr<SLIMSurface>> SLIMProjectionBase::fitTo(PointStore& store,
                                                               const CloudView& cloud) {
  auto made = std::make_shared<SLIMSurface>();
  const Error error = fitStore(store, cloud, *made);
  if (error && !(keeps_points_ && error.code == ErrorCode::kNoSurface)) return error;
  warning_ = error.message;
  return made;
}

CloudProjectionParams SLIMProjectionBase::projectionOn(const SLIMSurface& surface,
                                                       const ProjectionParams& params) const {
  CloudProjectionParams how;
  how.projection = params;
  how.projection.sharp_features = params_.sharp_features;
  how.projection.paper_mode = surface.info.paper_mode;
  how.viewpoint = params_.viewpoint;
  return how;
}

bool SLIMProjectionBase::projectMore(const CloudView& points, const ProjectionParams& params,
                                     CloudProjection& projection) {
  const CancellableRun cancellable(control_.progress);
  const SurfaceConstPtr surface = surface_ ? surface_ : fitted_surface_;
  if (!surface) return fail(ErrorCode::kNoSurface, "there is no surface to project onto");
  ProjectionParams how = params;
  how.threads = params_.threads;
  return guarded("the projection", "process fewer points", [&]() -> Error {
    auto made =
        CloudProjection::make(points, *surface, projectionOn(*surface, how), &control_.progress);
    if (!made) return made.error();
    projection = std::move(*made);
    return {};
  });
}

Error SLIMProjectionBase::fitAndProject(const CloudView& points, const CloudView& fitted,
                                        const ProjectionParams& params,
                                        CloudProjection& projection) {
  SurfaceConstPtr surface = surface_;
  std::optional<PointStore> store;
  if (surface) {
    if (Error error = surface->validate()) return error;
  } else {
    Result<PointStore> built = PointStore::build(fitted, params_.threads);
    if (!built) return built.error();
    store.emplace(std::move(*built));
    input_statistics_ = store->statistics();
    auto made = fitTo(*store, fitted);
    if (!made) return made.error();
    surface = *made;
    if (warning_.empty()) fitted_surface_ = surface;
  }
  CloudProjectionParams how = projectionOn(*surface, params);
  if (surface_) how.least_support = kLeastSharedSupport;
  const bool same = store && &points == &fitted;
  auto made =
      CloudProjection::make(points, *surface, how, &control_.progress, same ? &*store : nullptr);
  if (!made) return made.error();
  projection = std::move(*made);
  if (surface_) input_statistics_ = projection.inputStatistics();
  return {};
}

}  // namespace pcl_slim

// clang-format off
#define PCL_SLIM_INSTANTIATE_FOR(In)                                                   \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl_slim::PointCurvature)           \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl::PrincipalCurvatures)           \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl::Normal)
// clang-format on

PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_FOR)

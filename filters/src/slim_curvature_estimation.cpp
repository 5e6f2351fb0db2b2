// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_curvature_estimation.hpp"

#include <memory>
#include <utility>

#include "input_types.h"
#include "pcl_slim/filters/slim_projection_base.h"

namespace pcl_slim {

void SLIMProjectionBase::clearResults() {
  SLIMFitBase::clearResults();
  fitted_surface_.reset();
  no_surface_ = false;
  projection_ = {};
  unsupported_.clear();
  outside_.clear();
}

bool SLIMProjectionBase::project(const CloudView& points, const CloudView& fitted, FitParams fit,
                                 const ProjectionParams& requested, CloudProjection& projection,
                                 const ColorView& colors) {
  const CancellableRun cancellable(control_.progress);
  error_ = fit.validate();
  if (error_) return false;
  const bool done = guarded("the projection", "process fewer points", [&] {
    return fitAndProject(points, {fitted, colors}, &points == &fitted, fit, requested, projection);
  });
  if (!done) {
    fitted_surface_.reset();
    clearWarning();
    no_surface_ = false;
    return false;
  }
  projection_ = projection.statistics();
  const auto unsupported = projection.unsupported();
  unsupported_.assign(unsupported.begin(), unsupported.end());
  const auto outside = projection.outside();
  outside_.assign(outside.begin(), outside.end());
  return true;
}

bool SLIMProjectionBase::projectMore(const CloudView& points, const ProjectionParams& requested,
                                     CloudProjection& projection) {
  const CancellableRun cancellable(control_.progress);
  const SurfaceConstPtr surface = given_surface_ ? given_surface_ : fitted_surface_;
  if (!surface) return fail(ErrorCode::kNoSurface, "there is no surface to project onto");
  return guarded("the projection", "process fewer points", [&]() -> Error {
    // These are places: how many of them a given surface supports says nothing about it.
    auto made = projectScan(points, *surface, SurfaceOrigin::kFitted, params_, requested,
                            &control_.progress);
    if (!made) return made.error();
    projection = std::move(*made);
    return {};
  });
}

Error SLIMProjectionBase::fitAndProject(const CloudView& points, const ScanView& fitted, bool same,
                                        const FitParams& fit, const ProjectionParams& requested,
                                        CloudProjection& projection) {
  const SurfaceConstPtr given = given_surface_;
  if (!given) {
    auto made = projectOnFit(points, fitted, same, fit, requested);
    if (!made) return made.error();
    projection = std::move(*made);
    return {};
  }
  if (Error error = given->validate()) return error;
  auto made =
      projectScan(points, *given, SurfaceOrigin::kGiven, fit, requested, &control_.progress);
  if (!made) return made.error();
  projection = std::move(*made);
  input_statistics_ = projection.inputStatistics();
  return {};
}

Result<CloudProjection> SLIMProjectionBase::projectOnFit(const CloudView& points,
                                                         const ScanView& fitted, bool same,
                                                         const FitParams& fit,
                                                         const ProjectionParams& requested) {
  FittedScan scan;
  const Error error = fitAndKeep(fitted, fit, scan);
  // Points that are no surface may stay as they are: they are projected onto an empty one.
  if (error && !(keeps_points_ && error.code == ErrorCode::kNoSurface)) return error;
  no_surface_ = static_cast<bool>(error);
  if (error) {
    clearWarning();
    warn(error.message + "; the points stay as they are");
  }
  const auto surface = std::make_shared<const SLIMSurface>(std::move(scan.surface));
  if (!error) fitted_surface_ = surface;
  return projectScan(points, *surface, SurfaceOrigin::kFitted, fit, requested, &control_.progress,
                     same ? &scan.store : nullptr);
}

}  // namespace pcl_slim

// clang-format off
#define PCL_SLIM_INSTANTIATE_FOR(In)                                                   \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl_slim::PointCurvature)           \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl::PrincipalCurvatures)           \
  PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, pcl::Normal)
// clang-format on

PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_FOR)

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/scan/scan.h"

#include <utility>

#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/fit/fit_colors.h"

namespace pcl_slim {

namespace {

/** The parameters of a projection that follow from those of a fit. */
ProjectionParams withFit(const FitParams& fit, ProjectionParams requested) {
  requested.sharp_features = fit.sharp_features;
  requested.threads = fit.threads;
  return requested;
}

Error buildStore(const CloudView& points, int threads, PointStore& store) {
  Result<PointStore> built = PointStore::build(points, threads);
  if (!built) return built.error();
  store = std::move(*built);
  return {};
}

}  // namespace

Error fitScan(const ScanView& scan, const FitParams& params, FittedScan& fitted,
              Progress* progress) {
  fitted = {};
  if (Error error = params.validate()) return error;
  if (Error error = buildStore(scan.points, params.threads, fitted.store)) return error;
  return fitStoredScan(scan, params, fitted, progress);
}

Error fitStoredScan(const ScanView& scan, const FitParams& params, FittedScan& fitted,
                    Progress* progress) {
  Error error = fitSurface(fitted.store, params, fitted.surface, &fitted.statistics, progress);
  if (error) return error;
  const Stopwatch watch;
  error = fitColors(fitted.store, scan.points, scan.colors, params.threads, fitted.surface);
  fitted.color_seconds = watch.seconds();
  return error;
}

Result<CloudProjection> projectScan(const CloudView& points, const SLIMSurface& surface,
                                    SurfaceOrigin origin, const FitParams& fit,
                                    const ProjectionParams& requested, Progress* progress,
                                    const PointStore* store) {
  CloudProjectionParams params;
  params.projection = withFit(fit, requested);
  params.viewpoint = fit.viewpoint;
  if (origin == SurfaceOrigin::kFitted && store != nullptr && !fit.viewpoint) {
    const SideEvidence evidence = findSideEvidence(*store, {});
    if (evidence.source == SideSource::kOrigin) params.viewpoint = evidence.eye;
  }
  if (origin == SurfaceOrigin::kGiven) params.least_support = kLeastSharedSupport;
  return CloudProjection::make(points, surface, params, progress, store);
}

Error projectForLines(const PointStore& store, const SLIMSurface& surface, SurfaceOrigin origin,
                      const FitParams& fit, Projection& projection, Progress* progress) {
  ProjectionParams params;
  params.extremality = true;
  Error error = projectPoints(store, surface, withFit(fit, params), projection, progress);
  if (error || origin == SurfaceOrigin::kFitted) return error;
  const auto points = static_cast<double>(store.size());
  const double supported = points - static_cast<double>(projection.num_unsupported);
  if (supported >= kLeastSharedSupport * points) return {};
  return {ErrorCode::kBadArgument,
          "the surface supports less than a tenth of the points: it is of another cloud or faces "
          "the other way; give this cloud's"};
}

namespace {

Error traceStored(const SLIMSurface& surface, SurfaceOrigin origin, const FitParams& fit,
                  CrestParams crest, TracedScan& traced, Progress* progress) {
  const PointStore& store = traced.fitted.store;
  Projection projection;
  if (Error error = projectForLines(store, surface, origin, fit, projection, progress))
    return error;
  crest.threads = fit.threads;
  Error error = traceCrestLines(store, projection, surface, crest, traced.lines, &traced.statistics,
                                progress);
  // Checked after the last progress report: a caller who cancels gets no result.
  if (!error && progress != nullptr && progress->cancelled())
    error = {ErrorCode::kCancelled, "the tracing of lines was cancelled"};
  if (error) traced.lines = {};
  return error;
}

}  // namespace

Error traceScanLines(const CloudView& points, const SLIMSurface* given, const FitParams& fit,
                     const CrestParams& crest, TracedScan& traced, Progress* progress) {
  traced = {};
  if (Error error = fit.validate()) return error;
  if (Error error = crest.validate()) return error;
  FittedScan& fitted = traced.fitted;
  if (given != nullptr) {
    if (Error error = buildStore(points, fit.threads, fitted.store)) return error;
    if (Error error = given->validate()) return error;
    return traceStored(*given, SurfaceOrigin::kGiven, fit, crest, traced, progress);
  }
  if (Error error = fitScan({points, {}}, fit, fitted, progress)) return error;
  return traceStored(fitted.surface, SurfaceOrigin::kFitted, fit, crest, traced, progress);
}

}  // namespace pcl_slim

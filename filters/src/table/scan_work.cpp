// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/table/scan_work.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/filters/table/projected_fields.h"
#include "pcl_slim/scan/scan.h"

namespace pcl_slim {

namespace {

std::vector<std::string> fieldNames(const ScanWorkParams& params, bool move) {
  std::vector<std::string> names;
  if (move) names = {"x", "y", "z"};
  if (params.normals) names.insert(names.end(), {"normal_x", "normal_y", "normal_z", "curvature"});
  if (params.curvatures)
    names.insert(names.end(), {"k1", "k2", "mean_curvature", "gaussian_curvature"});
  return names;
}

bool allFinite(const PointTable& points, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const PointField& field = points.fields[static_cast<std::size_t>(findField(points, name))];
    for (std::size_t i = 0; i < numPoints(points); ++i)
      if (!std::isfinite(fieldValue(points, i, field))) return false;
    return true;
  });
}

/** A view of the scan's points, as the programs have it: a viewpoint replaces the places of sensors. */
CloudView viewOf(const ScanTable& scan, const ScanWorkParams& params) {
  CloudView view = scan.view(params.use_normals);
  if (params.fit.viewpoint) view.sensors = nullptr;
  return view;
}

/** Fits and projects. \param[out] result gets the statistics and the warning. */
Result<CloudProjection> projected(const CloudView& points, const ScanWorkParams& params,
                                  Progress* progress, ScanWorkResult& result) {
  FittedScan fitted;
  const Error error = fitScan({points, {}}, params.fit, fitted, progress);
  if (error && error.code != ErrorCode::kNoSurface) return error;
  if (error) result.warning = error.message;
  result.fit = fitted.statistics;
  ProjectionParams projection;
  projection.planes = params.normals;
  projection.directions = params.curvatures;
  return projectScan(points, fitted.surface, SurfaceOrigin::kFitted, params.fit, projection,
                     progress, &fitted.store);
}

Result<ScanWorkResult> work(const ScanTable& scan, const ScanWorkParams& params, bool move,
                            Progress* progress) {
  if (Error error = params.fit.validate()) return error;
  ScanWorkResult result;
  Result<CloudProjection> projection =
      scan.hasFinite() ? projected(viewOf(scan, params), params, progress, result)
                       : CloudProjection::ofNothing(scan.size());
  if (!projection) return projection.error();
  result.projection = projection->statistics();
  const std::vector<std::string> names = fieldNames(params, move);
  result.points = withProjected(scan.points, *projection, names, params.fit.threads);
  result.is_dense = scan.columns.num_non_finite == 0 && allFinite(result.points, names);
  return result;
}

}  // namespace

Result<ScanWorkResult> smoothScan(const ScanTable& scan, const ScanWorkParams& params,
                                  Progress* progress) {
  return work(scan, params, true, progress);
}

Result<ScanWorkResult> normalsOfScan(const ScanTable& scan, const ScanWorkParams& params,
                                     Progress* progress) {
  return work(scan, params, false, progress);
}

Result<PointTable> splatsOfScan(const ScanTable& scan, const SplatParams& params, bool use_normals,
                                SplatStatistics* statistics, Progress* progress) {
  if (Error error = params.validate()) return error;
  SplatSet splats;
  if (statistics) *statistics = {};
  if (scan.hasFinite()) {
    CloudView view = scan.view(use_normals);
    if (params.viewpoint) view.sensors = nullptr;
    if (Error error = sampleSplats(view, scan.colors(), params, splats, statistics, progress))
      return error;
  }
  return toPointFile(splats, {}).cloud;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "fit/smoothed_points.h"

#include <cmath>
#include <limits>

#include "support/lab/bench.h"

namespace pcl_slim::measure {

namespace {

void scatter(const PointStore& store, const Projection& projection, SmoothedPoints& result) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::uint32_t> place = store.storeOfInput();
  const double scale = store.scale();
  result.points.assign(place.size(), {kNone, kNone, kNone});
  result.normals.assign(place.size(), {});
  if (!projection.curvature.empty()) {
    result.mean.assign(place.size(), 0);
    result.gaussian.assign(place.size(), 0);
  }
  if (!projection.principal.empty()) {
    result.k1.assign(place.size(), 0);
    result.k2.assign(place.size(), 0);
  }
  for (std::size_t i = 0; i < place.size(); ++i) {
    const std::uint32_t s = place[i];
    if (s == PointStore::kSkipped) continue;
    const auto& n = projection.normal[s];
    result.points[i] = along(store.origin(), scale, projection.position[s]);
    result.normals[i] = {n[0], n[1], n[2]};
    if (!result.mean.empty()) {
      result.mean[i] = projection.curvature[s][0] / scale;
      result.gaussian[i] = projection.curvature[s][1] / (scale * scale);
    }
    if (!result.k1.empty()) {
      result.k1[i] = projection.principal[s].k1 / scale;
      result.k2[i] = projection.principal[s].k2 / scale;
    }
  }
}

}  // namespace

Result<SmoothedPoints> smoothPoints(const CloudView& cloud, const FitParams& fit,
                                    ProjectionParams how) {
  const double start = cpuSeconds();
  auto store = PointStore::build(cloud, fit.threads);
  if (!store) return store.error();
  SmoothedPoints result;
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fit, surface, &result.fit)) return error;
  how.threads = fit.threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, how, projection)) return error;
  scatter(*store, projection, result);
  result.seconds = cpuSeconds() - start;
  result.sigma = std::sqrt(result.fit.lambda) * store->diagonal() * store->scale();
  for (const std::uint32_t leaf : surface.leaves()) {
    result.leaves.push_back(along(store->origin(), store->scale(),
                                  {surface.cx[leaf], surface.cy[leaf], surface.cz[leaf]}));
  }
  return result;
}

CloudView viewOf(const std::vector<Vector3>& points) {
  CloudView view;
  view.xyz = points.data();
  view.scalar = CloudView::Scalar::kDouble;
  view.xyz_stride = sizeof(Vector3);
  view.size = points.size();
  return view;
}

}  // namespace pcl_slim::measure

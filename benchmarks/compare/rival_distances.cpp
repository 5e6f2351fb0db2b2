// SPDX-License-Identifier: BSD-3-Clause
#include "compare/rival_distances.h"

#include <cmath>
#include <limits>

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/cloud_projection.h"
#include "rivals/point_tree.h"
#include "support/lab/bench.h"

namespace pcl_slim::change {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct FittedScan {
  SLIMSurface surface;
  CloudProjection projection;
};

Result<FittedScan> fitted(const Scan& scan) {
  FittedScan made;
  auto store = PointStore::build(scan.view(), 1);
  if (!store) return store.error();
  FitParams params;
  params.threads = 1;
  if (Error error = fitSurface(*store, params, made.surface)) return error;
  CloudProjectionParams how;
  how.projection.errors = true;
  how.projection.threads = 1;
  Result<CloudProjection> projection =
      CloudProjection::make(scan.view(), made.surface, how, nullptr, &*store);
  if (!projection) return projection.error();
  made.projection = std::move(*projection);
  return made;
}

}  // namespace

Estimate nearestPoints(const Scan& scan, const Scan& reference,
                       const std::vector<std::size_t>& chosen) {
  Estimate made;
  const double start = measure::cpuSeconds();
  const rivals::PointTree tree(reference.points);
  for (const std::size_t i : chosen) {
    const Vector3 off =
        subtract(scan.points[i], reference.points[tree.nearest(scan.points[i], 1)[0]]);
    made.distance.push_back(std::copysign(length(off), dot(off, scan.normals[i])));
  }
  made.seconds = (measure::cpuSeconds() - start) * static_cast<double>(scan.points.size()) /
                 static_cast<double>(chosen.size());
  return made;
}

Estimate distancesToMesh(const Scan& scan, const TriangleMesh& mesh, double seconds,
                         const std::vector<std::size_t>& chosen) {
  Estimate made;
  const double start = measure::cpuSeconds();
  const Result<TriangleIndex> index = TriangleIndex::make(mesh, 1);
  if (!index) return made;
  const std::vector<TriangleFoot> feet = index->nearest(scan.points, Bounds::kInfinity, {}, 1);
  made.seconds = seconds + measure::cpuSeconds() - start;
  for (const std::size_t i : chosen) {
    const double turn = dot(feet[i].normal, scan.normals[i]) < 0 ? -1 : 1;
    made.distance.push_back(feet[i].border ? kNone : turn * feet[i].distance);
  }
  return made;
}

Result<Estimate> surfaceDistances(const Scan& scan, const Scan& reference,
                                  const std::vector<std::size_t>& chosen, TriangleMesh& mesh,
                                  double& mesh_seconds) {
  double start = measure::cpuSeconds();
  const Result<FittedScan> base = fitted(reference);
  if (!base) return base.error();
  const double base_seconds = measure::cpuSeconds() - start;
  start = measure::cpuSeconds();
  MeshParams mesh_params;
  mesh_params.threads = 1;
  if (Error error = extractMesh(base->surface, mesh_params, mesh)) return error;
  mesh_seconds = base_seconds + measure::cpuSeconds() - start;
  start = measure::cpuSeconds();
  const Result<FittedScan> own = fitted(scan);
  if (!own) return own.error();
  std::vector<Vector3> positions(scan.points.size());
  std::vector<float> sigma(scan.points.size());
  std::vector<std::array<float, 3>> normals(scan.points.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const ProjectedPoint p = own->projection.point(i);
    positions[i] = p.position;
    sigma[i] = p.errors.position;
    normals[i] = p.normal;
  }
  const Result<DeviationReference> index = DeviationReference::make(base->surface, 1);
  if (!index) return index.error();
  DeviationPlaces places;
  places.positions = positions.data();
  places.count = positions.size();
  places.sigma = sigma.data();
  DeviationParams params;
  params.feet.threads = 1;
  Deviations deviations;
  if (Error error = measureDeviations(*index, places, params, deviations)) return error;
  Estimate made;
  made.seconds = base_seconds + measure::cpuSeconds() - start;
  for (const std::size_t i : chosen) {
    const auto& n = deviations.normal[i];
    const double turn = dot({n[0], n[1], n[2]}, scan.normals[i]) < 0 ? -1 : 1;
    const bool found = deviations.state[i] == FootState::kFound && own->projection.isSupported(i);
    made.distance.push_back(found ? turn * deviations.distance[i] : kNone);
    made.detection.push_back(deviations.detection[i]);
  }
  return made;
}

}  // namespace pcl_slim::change

// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/sensor_errors.h"

#include <cmath>

#include "pcl_slim/query/projection.h"
#include "rivals/mls.h"

namespace pcl_slim::measure {

namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;
constexpr double kMillimetres = 1000;

/** Sums of squares, solid by solid. */
class ErrorSums {
 public:
  explicit ErrorSums(const SensorScan& scan) : scan_(scan), sums_(scan.solids.size()) {}

  void add(std::size_t point, const Vector3& place, const Vector3& normal) {
    const int solid = scan_.solid[point];
    if (solid < 0) return;
    const Foot foot = footOn(scan_.solids[static_cast<std::size_t>(solid)], place);
    Sums& sums = sums_[static_cast<std::size_t>(solid)];
    sums.distance += foot.distance * foot.distance;
    ++sums.points;
    if (!(dot(normal, normal) > 0)) return;
    const double angle =
        std::atan2(length(cross(normal, foot.normal)), std::abs(dot(normal, foot.normal)));
    sums.angle += angle * angle;
    ++sums.normals;
  }

  SensorErrors errors() const {
    SensorErrors errors;
    Sums all;
    for (const Sums& sums : sums_) {
      all.distance += sums.distance;
      all.points += sums.points;
      all.angle += sums.angle;
      all.normals += sums.normals;
      errors.positions.push_back(positionOf(sums));
      errors.normals.push_back(normalOf(sums));
    }
    errors.position = positionOf(all);
    errors.normal = normalOf(all);
    return errors;
  }

 private:
  struct Sums {
    double distance = 0, angle = 0, points = 0, normals = 0;
  };

  static double positionOf(const Sums& sums) {
    return kMillimetres * std::sqrt(sums.distance / sums.points);
  }
  static double normalOf(const Sums& sums) {
    return kDegreesPerRadian * std::sqrt(sums.angle / sums.normals);
  }

  const SensorScan& scan_;
  std::vector<Sums> sums_;
};

CloudView viewOf(const SensorScan& scan) {
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  return view;
}

bool isBesideAnother(const SensorScan& scan, std::size_t point, double distance) {
  const float* p = &scan.points[3 * point];
  for (std::size_t s = 0; s < scan.solids.size(); ++s) {
    const bool own = static_cast<int>(s) == scan.solid[point];
    if (!own && std::abs(footOn(scan.solids[s], {p[0], p[1], p[2]}).distance) < distance)
      return true;
  }
  return false;
}

}  // namespace

void leaveOutCreases(double distance, SensorScan& scan) {
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (isBesideAnother(scan, i, distance)) scan.solid[i] = -1;
  }
}

Result<SensorErrors> errorsOfFit(const SensorScan& scan, const FitParams& params,
                                 FitStatistics& statistics, const Fitter& fitter) {
  const auto store = PointStore::build(viewOf(scan), params.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  Error error = fitter ? fitter(*store, params, surface, &statistics)
                       : fitSurface(*store, params, surface, &statistics);
  if (error) return error;
  Projection projection;
  ProjectionParams how;
  how.threads = params.threads;
  error = projectPoints(*store, surface, how, projection);
  if (error) return error;
  ErrorSums sums(scan);
  for (std::size_t i = 0; i < store->size(); ++i) {
    const auto& n = projection.normal[i];
    sums.add(store->orderOfStore()[i],
             along(store->origin(), store->scale(), projection.position[i]), {n[0], n[1], n[2]});
  }
  SensorErrors errors = sums.errors();
  errors.unit = kMillimetres * store->scale() * store->diagonal();
  return errors;
}

SensorErrors errorsOf(const SensorScan& scan, const std::vector<Vector3>& places,
                      const std::vector<Vector3>& normals) {
  ErrorSums sums(scan);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool has_normal = std::isfinite(normals[i][0]);
    if (std::isfinite(places[i][0])) sums.add(i, places[i], has_normal ? normals[i] : Vector3{});
  }
  return sums.errors();
}

SensorErrors errorsOfMls(const SensorScan& scan, double radius) {
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    points.push_back({scan.points[3 * i], scan.points[3 * i + 1], scan.points[3 * i + 2]});
  }
  const rivals::Smoothed smoothed = rivals::smoothByMls(points, 2, radius);
  return errorsOf(scan, smoothed.points, smoothed.normals);
}

}  // namespace pcl_slim::measure

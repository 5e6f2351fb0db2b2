// SPDX-License-Identifier: BSD-3-Clause
#include "fit/accuracy.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/query/projection.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace pcl_slim::measure {

namespace {

constexpr double kDegreesPerRadian = 57.29577951308232;

/** Angle in radians between two directions regardless of sign; sound for the smallest angles.
 * \param[out] same_side whether they point to one side. */
double angleBetween(const std::array<float, 3>& n, const std::array<double, 3>& truth,
                    bool& same_side) {
  double cross_sq = 0, dot = 0;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const double x = n[b] * truth[c] - n[c] * truth[b];
    cross_sq += x * x;
    dot += n[a] * truth[a];
  }
  same_side = dot >= 0;
  return std::atan2(std::sqrt(cross_sq), std::abs(dot));
}

Accuracy compare(Shape shape, const PointStore& store, const Projection& projection) {
  Accuracy e;
  double curvature_sq = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    std::array<double, 3> p = projection.position[i];
    for (int a = 0; a < 3; ++a) p[a] = store.origin()[a] + store.scale() * p[a];
    const Truth truth = truthAt(shape, p);
    e.position += truth.distance * truth.distance;
    e.worst = std::max(e.worst, std::abs(truth.distance));
    if (!projection.supported[i] || truth.rim) continue;
    bool same_side = true;
    const double angle = angleBetween(projection.normal[i], truth.normal, same_side);
    e.normal += angle * angle;
    const double mean = (same_side ? 1 : -1) * projection.curvature[i][0] / store.scale();
    e.curvature += (mean - truth.mean_curvature) * (mean - truth.mean_curvature);
    curvature_sq += truth.mean_curvature * truth.mean_curvature;
    ++count;
  }
  e.position = std::sqrt(e.position / static_cast<double>(store.size()));
  e.normal = kDegreesPerRadian * std::sqrt(e.normal / static_cast<double>(count));
  e.curvature = std::sqrt(e.curvature / curvature_sq);
  return e;
}

}  // namespace

Result<Outcome> measureAccuracy(Shape shape, const Scene& scene, const FitParams& params,
                                bool normals, bool float_input, const Fitter& fitter) {
  std::vector<float> floats;
  if (float_input) floats.assign(scene.points.begin(), scene.points.end());
  const CloudView view = viewOf(scene, float_input ? &floats : nullptr, normals);
  const auto store = PointStore::build(view, params.threads);
  if (!store) return store.error();
  Outcome outcome;
  SLIMSurface surface;
  if (Error error = fitter ? fitter(*store, params, surface, &outcome.fit)
                           : fitSurface(*store, params, surface, &outcome.fit)) {
    return error;
  }
  ProjectionParams projection_params;
  projection_params.curvature = true;
  projection_params.threads = params.threads;
  Projection projection;
  if (Error error = projectPoints(*store, surface, projection_params, projection)) return error;
  outcome.accuracy = compare(shape, *store, projection);
  outcome.unsupported = projection.num_unsupported;
  const double diagonal = store->diagonal() * store->scale();
  outcome.sigma = std::sqrt(outcome.fit.lambda) * diagonal / scene.diagonal;
  return outcome;
}

}  // namespace pcl_slim::measure

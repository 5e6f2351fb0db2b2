// SPDX-License-Identifier: BSD-3-Clause
#include "stress/stress_classes.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/lab/reference/reference_renderer.h"

namespace pcl_slim_test {

namespace {

using namespace pcl_slim;

constexpr double kMostGathered = 3000;  ///< points gathered into balls for each point stored
constexpr double kMostTriangles = 300;  ///< of a mesh, for each point stored

StressOutcome result() {
  return {StressOutcome::Kind::kResult, ""};
}

StressOutcome failed(const std::string& text) {
  return {StressOutcome::Kind::kFailed, text};
}

/** A refusal: one sentence, where one is allowed. */
StressOutcome refused(const Error& error, bool allowed) {
  const bool sentence = error.message.size() > 10 && error.message.find('\n') == std::string::npos;
  if (!sentence) return failed("an error without a sentence");
  if (!allowed) return failed("refused: " + error.message);
  return {StressOutcome::Kind::kRefused, error.message};
}

template <typename Values>
bool allFinite(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](auto value) { return std::isfinite(value); });
}

/** A cloud brought into order and fitted. */
struct Fit {
  PointStore store;
  SLIMSurface surface;
  FitStatistics statistics;
  Error error;
};

Fit fitTo(const StressCloud& cloud) {
  Fit fit;
  Result<PointStore> store = PointStore::build(cloud.cloud(), 1);
  if (!store) {
    fit.error = store.error();
    return fit;
  }
  fit.store = std::move(*store);
  FitParams params;
  params.threads = 1;
  fit.error = fitSurface(fit.store, params, fit.surface, &fit.statistics);
  return fit;
}

std::string defectOf(const Fit& fit) {
  if (const Error error = fit.surface.validate()) return error.message;
  if (!allFinite(fit.surface.error) || !allFinite(fit.surface.effective_count)) {
    return "an error or a count is not finite";
  }
  if (!std::isfinite(fit.surface.info.lambda)) return "lambda is not finite";
  const auto points = static_cast<double>(fit.store.size());
  if (static_cast<double>(fit.statistics.gathered) > kMostGathered * points) {
    return "gathers " + std::to_string(fit.statistics.gathered) + " for " +
           std::to_string(fit.store.size()) + " points";
  }
  return "";
}

/** The same points in another order, repeated, and among points that are nowhere. */
template <typename Bytes>
std::string variance(const StressCloud& cloud, std::mt19937_64& random, const Bytes& bytes) {
  const auto expected = bytes(cloud);
  if (bytes(cloud.mixed(random, 1, 0)) != expected) return "depends on the order of points";
  if (bytes(cloud.mixed(random, 1, cloud.size() / 3 + 1)) != expected) {
    return "depends on points that are nowhere";
  }
  if (bytes(cloud.mixed(random, 2, 0)) != expected) return "depends on how often points are given";
  return "";
}

StressOutcome judgeFit(const StressCloud& cloud, const Fit& fit, std::mt19937_64& random) {
  if (fit.error) {
    return fit.surface.empty() ? refused(fit.error, !cloud.must_succeed)
                               : failed("a surface beside an error");
  }
  if (const std::string defect = defectOf(fit); !defect.empty()) return failed(defect);
  if (fit.statistics.leaves == 0) return failed("no leaf and no error");
  if (!cloud.one_look || cloud.size() > 5000) return result();
  const std::string found = variance(
      cloud, random, [](const StressCloud& other) { return encodeSlim(fitTo(other).surface); });
  return found.empty() ? result() : failed(found);
}

/** RMS distance of the projected points that are on the wave, in its own units; supported ones. */
double waveError(const StressCloud& cloud, const Fit& fit, const Projection& projection) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    if (fit.store.orderOfStore()[i] >= cloud.on_wave || !projection.supported[i]) continue;
    double p[3];
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = fit.store.origin()[a] + fit.store.scale() * projection.position[i][a];
    }
    sum += std::pow(cloud.distance(p), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

Error project(const Fit& fit, Projection& projection) {
  ProjectionParams params;
  params.curvature = params.directions = true;
  params.threads = 1;
  return projectPoints(fit.store, fit.surface, params, projection);
}

/** The error of the wave as it was before anything was done to it. */
double undisturbedError(const StressCloud& cloud) {
  StressCloud still = cloud;
  const std::size_t n = cloud.on_wave;
  still.points.resize(3 * n);
  if (!still.normals.empty()) still.normals.resize(3 * n);
  still.bgr.resize(3 * n);
  for (double& value : still.points) value = (value - cloud.offset) / cloud.scale;
  still.scale = 1;
  still.offset = 0;
  const Fit fit = fitTo(still);
  Projection projection;
  if (fit.error || project(fit, projection)) return 0.0;
  return waveError(still, fit, projection);
}

StressOutcome judgeProjection(const StressCloud& cloud, const Fit& fit) {
  Projection projection;
  if (const Error error = project(fit, projection)) return refused(error, false);
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    const auto& k = projection.principal[i];
    if (!allFinite(projection.position[i]) || !allFinite(projection.normal[i]) ||
        !allFinite(projection.curvature[i]) || !std::isfinite(k.k1) || !std::isfinite(k.k2)) {
      return failed("a projected point is not finite");
    }
  }
  if (cloud.on_wave == 0 || !cloud.must_succeed) return result();
  const double left = waveError(cloud, fit, projection),
               rounding = 1e-15 * std::abs(cloud.offset / cloud.scale);
  const double most =
      cloud.error_factor * undisturbedError(cloud) + 4 * rounding + cloud.error_slack;
  if (left <= most) return result();
  return failed("error " + std::to_string(left) + " of at most " + std::to_string(most));
}

SplatParams splatParams(const StressCloud& cloud) {
  SplatParams params;
  params.threads = 1;
  params.initial_resolution = cloud.resolution;
  params.max_depth = cloud.max_depth;
  return params;
}

/** All that is written of splats, as numbers. */
std::vector<double> numbersOf(const SplatSet& splats) {
  std::vector<double> numbers(splats.origin.begin(), splats.origin.end());
  for (const auto* column : {&splats.x, &splats.y, &splats.z, &splats.nx, &splats.ny, &splats.nz,
                             &splats.radius, &splats.confidence, &splats.normal_variance}) {
    numbers.insert(numbers.end(), column->begin(), column->end());
  }
  numbers.insert(numbers.end(), splats.rgb.begin(), splats.rgb.end());
  return numbers;
}

StressOutcome judgeSplats(const StressCloud& cloud, SplatSet& splats, std::mt19937_64& random) {
  const SplatParams params = splatParams(cloud);
  const auto sample = [&params](const StressCloud& other) {
    SplatSet made;
    const Error error = sampleSplats(other.cloud(), other.colors(), params, made);
    return error ? std::vector<double>() : numbersOf(made);
  };
  const Error error = sampleSplats(cloud.cloud(), cloud.colors(), params, splats);
  if (error)
    return splats.empty() ? refused(error, !cloud.must_succeed) : failed("splats, and an error");
  if (splats.empty()) return failed("no splat and no error");
  if (!allFinite(numbersOf(splats))) return failed("a splat is not finite");
  if (const Error bad = validateDiscs(splats)) return failed(bad.message);
  if (cloud.size() > 5000) return result();
  const std::string found = variance(cloud, random, sample);
  return found.empty() ? result() : failed(found);
}

Camera cameraOf(const StressCloud& cloud, const BoundingSpheres& object) {
  Camera camera = cameraFor(chooseView(object), object, {24, 18});
  const std::size_t middle = 3 * (cloud.size() / 2);
  const double* at = cloud.points.data() + middle;
  const double size = std::max(std::abs(cloud.scale), 1e-37);
  switch (cloud.camera) {
    case StressView::kFront: break;
    case StressView::kGrazing:
      camera.position = {at[0] - 3 * size, at[1], at[2]};
      camera.look_at = {at[0], at[1], at[2]};
      camera.up = {0, 0, 1};
      break;
    case StressView::kInside: camera.position = {at[0], at[1], at[2] - 0.02 * size}; break;
    case StressView::kTouching: camera.position = {at[0], at[1], at[2]}; break;
    case StressView::kNoArea: camera.size = {camera.size.width, 0}; break;
  }
  return camera;
}

/** A picture, or a refusal where its camera has no area. */
StressOutcome judgePicture(const StressCloud& cloud, const GBuffer& buffer, const Error& error) {
  const bool no_area = cloud.camera == StressView::kNoArea;
  if (error) return refused(error, no_area || !cloud.must_succeed);
  if (no_area) return failed("a picture of no area");
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (std::isnan(buffer.depth[i]) || !allFinite(buffer.normal[i]))
      return failed("a pixel is NaN");
    if (!buffer.mean_curvature.empty() && std::isnan(buffer.mean_curvature[i])) {
      return failed("a curvature is NaN");
    }
  }
  return result();
}

StressOutcome judgeRender(const StressCloud& cloud, const Fit& fit) {
  SurfaceRenderer renderer(fit.surface, 1);
  const Camera camera = cameraOf(cloud, spheresOf(fit.surface));
  for (const bool reference : {false, true}) {
    RenderParams params;
    params.threads = 1;
    GBuffer buffer;
    const Error error = reference ? lab::renderReference(fit.surface, camera, params, buffer)
                                  : renderer.render(camera, params, buffer);
    const StressOutcome outcome = judgePicture(cloud, buffer, error);
    if (outcome.kind != StressOutcome::Kind::kResult) return outcome;
  }
  return result();
}

StressOutcome judgeDiscs(const StressCloud& cloud, const SplatSet& splats) {
  DiscRenderParams params;
  params.threads = 1;
  GBuffer buffer;
  const Error error = renderDiscs(splats, cameraOf(cloud, spheresOf(splats)), params, buffer);
  return judgePicture(cloud, buffer, error);
}

StressOutcome judgeMesh(const Fit& fit) {
  MeshParams params;
  params.threads = 1;
  TriangleMesh mesh, again;
  MeshStatistics statistics;
  if (const Error error = extractMesh(fit.surface, params, mesh, &statistics)) {
    return mesh.triangles.empty() ? refused(error, true) : failed("a mesh beside an error");
  }
  const MeshCensus& census = statistics.census;
  if (mesh.triangles.empty()) return failed("no triangle and no error");
  if (census.nonmanifold_edges + census.nonmanifold_vertices + census.turned_edges > 0) {
    return failed("the mesh is not manifold");
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!allFinite(mesh.vertices[v]) || !allFinite(mesh.normals[v]) || !std::isfinite(mesh.k1[v]) ||
        !std::isfinite(mesh.k2[v])) {
      return failed("a vertex is not finite");
    }
  }
  if (static_cast<double>(census.triangles) >
      kMostTriangles * static_cast<double>(fit.store.size() + 100)) {
    return failed(std::to_string(census.triangles) + " triangles");
  }
  params.threads = 3;
  if (extractMesh(fit.surface, params, again)) return failed("refused with three threads");
  const bool same = again.vertices == mesh.vertices && again.triangles == mesh.triangles;
  return same ? result() : failed("depends on the number of threads");
}

}  // namespace

const std::vector<const char*>& stressClasses() {
  static const std::vector<const char*> names = {"fit",    "projection",        "picture",
                                                 "splats", "picture of splats", "mesh"};
  return names;
}

std::vector<StressOutcome> runClasses(const StressCloud& cloud, std::mt19937_64& random) {
  std::vector<StressOutcome> outcomes(stressClasses().size());
  const Fit fit = fitTo(cloud);
  outcomes[0] = judgeFit(cloud, fit, random);
  if (!fit.error) {
    outcomes[1] = judgeProjection(cloud, fit);
    outcomes[2] = judgeRender(cloud, fit);
    outcomes[5] = judgeMesh(fit);
  }
  SplatSet splats;
  outcomes[3] = judgeSplats(cloud, splats, random);
  if (!splats.empty()) outcomes[4] = judgeDiscs(cloud, splats);
  return outcomes;
}

}  // namespace pcl_slim_test

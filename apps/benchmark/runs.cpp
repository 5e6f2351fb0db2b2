// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/runs.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench_common.h"
#include "pcl_slim/slim/fit.h"
#include "pcl_slim/slim/projection.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kLongRun = 2.0;  // seconds; chance is small beside it
constexpr double kDegreesPerRadian = 57.29577951308232;

/** What a method gives back, in the order of the input. */
struct Treated {
  pcl::PointCloud<pcl::PointNormal> points;
  std::vector<float> mean_curvature;  ///< positive where bent away from the normal; may be empty
  std::vector<std::uint8_t> done;     ///< 0: no result, the point as it came
  bool moves_points = true;
};

/** CPU and wall time since construction. */
struct Clock {
  double cpu = bench::cpuSeconds(), wall = bench::wallSeconds();

  void stop(Run& run) const
  {
    run.cpu = bench::cpuSeconds() - cpu;
    run.wall = bench::wallSeconds() - wall;
  }
};

/** The input as output, no point done. */
void
startFrom(const Scene& scene, Treated& treated)
{
  treated.points.resize(scene.size());
  treated.done.assign(scene.size(), 0);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    treated.points[i].getVector3fMap() = (*scene.points)[i].getVector3fMap();
  }
}

CloudView
viewOf(const Scene& scene, bool normals)
{
  CloudView view;
  view.xyz = scene.points->data();
  view.xyz_stride = sizeof(pcl::PointXYZ);
  view.size = scene.size();
  if (normals) {
    view.normal = scene.normals.data();
    view.normal_stride = 3 * sizeof(float);
  }
  return view;
}

/** Brings the store's results into the order and precision of PCL's cloud. */
void
collect(const Scene& scene, const PointStore& store, const std::vector<std::uint32_t>& stored,
        const Projection& projection, Treated& treated)
{
  startFrom(scene, treated);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const std::uint32_t s = stored[i];
    if (s == PointStore::kSkipped || !projection.supported[s]) continue;
    const auto& p = projection.position[s];
    pcl::PointNormal& out = treated.points[i];
    for (int a = 0; a < 3; ++a) {
      out.data[a] = static_cast<float>(store.origin()[a] + store.scale() * p[a]);
      out.data_n[a] = projection.normal[s][a];
    }
    treated.done[i] = 1;
  }
}

Error
runSlim(const Scene& scene, const Setting& setting, Run& run, Treated& treated)
{
  FitParams fit;
  fit.degree = setting.degree;
  fit.penalty = setting.penalty;
  fit.t_mdl = setting.t_mdl;
  fit.sharp_features = setting.sharp;
  fit.threads = setting.threads;
  ProjectionParams project;
  project.sharp_features = setting.sharp;
  project.threads = setting.threads;

  const Clock clock;
  const auto store = PointStore::build(viewOf(scene, setting.normals), setting.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fit, surface)) return error;
  Projection projection;
  if (Error error = projectPoints(*store, surface, project, projection)) return error;
  const std::vector<std::uint32_t> stored = store->storeOfInput();
  collect(scene, *store, stored, projection, treated);
  clock.stop(run);

  project.curvature = true;
  if (Error error = projectPoints(*store, surface, project, projection)) return error;
  treated.mean_curvature.resize(scene.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (!treated.done[i]) continue;
    treated.mean_curvature[i] =
        projection.curvature[stored[i]][0] / static_cast<float>(store->scale());
  }
  return {};
}

/** MLS drops points with too few neighbours and hands out the others in its threads' order. */
void
runMls(const Scene& scene, const Setting& setting, Run& run, Treated& treated)
{
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
  mls.setInputCloud(scene.points);
  mls.setComputeNormals(true);
  mls.setPolynomialOrder(setting.degree);
  mls.setSearchRadius(scene.spacing * std::sqrt(setting.neighbours / M_PI));
  mls.setNumberOfThreads(static_cast<unsigned>(setting.threads));
  mls.setCacheMLSResults(true);  // without it several threads share one result (PCL 1.13)
  pcl::PointCloud<pcl::PointNormal> output;
  const Clock clock;
  mls.process(output);
  clock.stop(run);

  startFrom(scene, treated);
  if (setting.degree > 1) treated.mean_curvature.assign(scene.size(), 0.0f);
  const pcl::Indices& source = mls.getCorrespondingIndices()->indices;
  for (std::size_t o = 0; o < output.size(); ++o) {
    const auto i = static_cast<std::size_t>(source[o]);
    if (!output[o].getVector3fMap().allFinite() || !output[o].getNormalVector3fMap().allFinite()) {
      continue;
    }
    treated.points[i] = output[o];
    treated.done[i] = 1;
    const pcl::MLSResult& fit = mls.getMLSResults()[i];
    // With fewer points than coefficients there is a plane only.
    if (setting.degree < 2 || 2 * fit.num_neighbors < (fit.order + 1) * (fit.order + 2)) continue;
    // Its polynomial is a height along its normal: a bulge is negative there.
    const Eigen::Vector2f k = fit.calculatePrincipalCurvatures(0, 0);
    treated.mean_curvature[i] = -0.5f * (k[0] + k[1]);
  }
}

void
runNormals(const Scene& scene, const Setting& setting, Run& run, Treated& treated)
{
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(
      static_cast<unsigned>(setting.threads));
  estimation.setInputCloud(scene.points);
  estimation.setKSearch(setting.neighbours);
  pcl::PointCloud<pcl::Normal> output;
  const Clock clock;
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(false));
  estimation.compute(output);
  clock.stop(run);

  startFrom(scene, treated);
  treated.moves_points = false;
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (!output[i].getNormalVector3fMap().allFinite()) continue;
    treated.points[i].getNormalVector3fMap() = output[i].getNormalVector3fMap();
    treated.done[i] = 1;
  }
}

/** Angle in radians between two directions regardless of sign; sound for the smallest angles.
 * \param[out] same_side whether they point to one side. */
double
angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool& same_side)
{
  const double dot = a.dot(b);
  same_side = dot >= 0;
  return std::atan2(a.cross(b).norm(), std::abs(dot));
}

void
measure(const Scene& scene, const Treated& treated, Run& run)
{
  double position = 0, worst = 0, normal = 0, curvature = 0, true_curvature = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const pcl::PointNormal& p = treated.points[i];
    const bench::Truth truth = scene.truth(i, {p.x, p.y, p.z});
    position += truth.distance * truth.distance;
    worst = std::max(worst, std::abs(truth.distance));
    if (!treated.done[i]) ++run.kept;
    if (!treated.done[i] || truth.rim) continue;
    bool same_side = true;
    const Eigen::Vector3d true_normal(truth.normal.data());
    const double angle =
        angleBetween(p.getNormalVector3fMap().cast<double>(), true_normal, same_side);
    normal += angle * angle;
    ++count;
    if (treated.mean_curvature.empty()) continue;
    const double mean = (same_side ? 1 : -1) * treated.mean_curvature[i];
    curvature += (mean - truth.mean_curvature) * (mean - truth.mean_curvature);
    true_curvature += truth.mean_curvature * truth.mean_curvature;
  }
  Errors& e = run.errors;
  if (treated.moves_points) {
    e.position = std::sqrt(position / static_cast<double>(scene.size())) / scene.unit;
    e.worst = worst / scene.unit;
  }
  if (count == 0) return;
  if (scene.has_true_normals) {
    e.normal = kDegreesPerRadian * std::sqrt(normal / static_cast<double>(count));
  }
  if (scene.has_true_curvature && !treated.mean_curvature.empty()) {
    e.curvature = std::sqrt(curvature / true_curvature);
  }
}

Error
checkSetting(const Scene& scene, const Setting& s)
{
  if (s.method == Method::kSlim && s.normals && scene.normals.empty()) {
    return {ErrorCode::kBadArgument, scene.name + " has no normals; fit it without them"};
  }
  if (s.method != Method::kSlim && s.neighbours < 3) {
    return {ErrorCode::kBadArgument, "fewer than 3 neighbours are no surface; give more"};
  }
  if (s.method == Method::kMls && s.degree < 1) {
    return {ErrorCode::kBadArgument, "MLS has no order below 1; give 1 or more"};
  }
  return {};
}

}  // namespace

std::string
methodName(Method method)
{
  return method == Method::kSlim ? "slim" : method == Method::kMls ? "mls" : "normals";
}

std::string
Setting::text() const
{
  char part[64];
  if (method == Method::kNormals) return "k " + std::to_string(neighbours);
  if (method == Method::kMls) {
    return "order " + std::to_string(degree) + " k " + std::to_string(neighbours);
  }
  std::string text = automatic() ? "default" : sharp ? "sharp" : "";
  const auto add = [&](const char* name, double value) {
    std::snprintf(part, sizeof(part), "%s%s %g", text.empty() ? "" : " ", name, value);
    text += part;
  };
  if (degree > 0) add("degree", degree);
  if (penalty > 0) add("kappa", penalty);
  if (t_mdl > 0) add("T", t_mdl);
  return text;
}

Result<Run>
runSetting(const Scene& scene, const Setting& setting, int repeats)
{
  if (Error error = checkSetting(scene, setting)) return error;
  Run run;
  run.setting = setting;
  Treated treated;
  std::vector<double> cpu, wall;
  for (int r = 0; r < std::max(1, repeats); ++r) {
    treated = Treated();
    const bench::MemoryGauge memory;
    if (setting.method == Method::kMls) {
      runMls(scene, setting, run, treated);
    } else if (setting.method == Method::kNormals) {
      runNormals(scene, setting, run, treated);
    } else if (Error error = runSlim(scene, setting, run, treated)) {
      return error;
    }
    cpu.push_back(run.cpu);
    wall.push_back(run.wall);
    if (r == 0) run.peak_bytes = memory.peakBytes();
    if (run.wall > kLongRun) break;
  }
  run.cpu = bench::median(cpu);
  run.wall = bench::median(wall);
  measure(scene, treated, run);
  return run;
}

}  // namespace pcl_slim::comparison

// SPDX-License-Identifier: BSD-3-Clause
#include "comparison/treat.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <cmath>
#include <cstdio>

#include "pcl_slim/query/projection.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace pcl_slim::comparison {

namespace {

/** CPU and wall time since construction. */
struct Clock {
  double cpu = measure::cpuSeconds(), wall = measure::wallSeconds();

  void stop(Treated& treated) const {
    treated.cpu = measure::cpuSeconds() - cpu;
    treated.wall = measure::wallSeconds() - wall;
  }
};

/** The input as output, no point done. */
void startFrom(const Scene& scene, Treated& treated) {
  treated.points.resize(scene.size());
  treated.done.assign(scene.size(), 0);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    treated.points[i].getVector3fMap() = (*scene.points)[i].getVector3fMap();
  }
}

CloudView viewOf(const Scene& scene, bool normals) {
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
void collect(const Scene& scene, const PointStore& store, const std::vector<std::uint32_t>& stored,
             const Projection& projection, Treated& treated) {
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

Error runSlim(const Scene& scene, const Setting& setting, Treated& treated) {
  ProjectionParams project;
  project.sharp_features = setting.sharp;
  project.threads = setting.threads;

  const Clock clock;
  const auto store = PointStore::build(viewOf(scene, setting.normals), setting.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  if (Error error = fitSurface(*store, fitParams(setting), surface)) return error;
  Projection projection;
  if (Error error = projectPoints(*store, surface, project, projection)) return error;
  const std::vector<std::uint32_t> stored = store->storeOfInput();
  collect(scene, *store, stored, projection, treated);
  clock.stop(treated);

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

/** Mean curvature of MLS's polynomial, a height along its normal: a bulge is negative there.
 * (MLSResult::calculatePrincipalCurvatures asserts that rounding spares H^2 - K >= 0; it does not.)
 */
float meanCurvature(const pcl::MLSResult& fit) {
  const auto d = fit.getPolynomialPartialDerivative(0, 0);
  const double length_sq = 1 + d.z_u * d.z_u + d.z_v * d.z_v;
  const double sum =
      (1 + d.z_v * d.z_v) * d.z_uu - 2 * d.z_u * d.z_v * d.z_uv + (1 + d.z_u * d.z_u) * d.z_vv;
  return static_cast<float>(-0.5 * sum / (length_sq * std::sqrt(length_sq)));
}

/** MLS drops points with too few neighbours and hands out the others in its threads' order. */
void runMls(const Scene& scene, const Setting& setting, Treated& treated) {
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
  mls.setInputCloud(scene.points);
  mls.setComputeNormals(true);
  mls.setPolynomialOrder(setting.degree);
  mls.setSearchRadius(scene.spacing * std::sqrt(setting.neighbours / M_PI));
  mls.setNumberOfThreads(static_cast<unsigned>(setting.threads));
  if (setting.judged) {
    auto indices = std::make_shared<pcl::Indices>();
    for (std::size_t i = 0; i < scene.size(); ++i) {
      if (scene.isJudged(i)) indices->push_back(static_cast<pcl::index_t>(i));
    }
    mls.setIndices(indices);
  }
  mls.setCacheMLSResults(true);  // without it several threads share one result (PCL 1.13)
  pcl::PointCloud<pcl::PointNormal> output;
  const Clock clock;
  mls.process(output);
  clock.stop(treated);

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
    treated.mean_curvature[i] = meanCurvature(fit);
  }
}

void runNormals(const Scene& scene, const Setting& setting, Treated& treated) {
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(
      static_cast<unsigned>(setting.threads));
  estimation.setInputCloud(scene.points);
  estimation.setKSearch(setting.neighbours);
  pcl::PointCloud<pcl::Normal> output;
  const Clock clock;
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(false));
  estimation.compute(output);
  clock.stop(treated);

  startFrom(scene, treated);
  treated.moves_points = false;
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (!output[i].getNormalVector3fMap().allFinite()) continue;
    treated.points[i].getNormalVector3fMap() = output[i].getNormalVector3fMap();
    treated.done[i] = 1;
  }
}

Error checkSetting(const Scene& scene, const Setting& s) {
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

std::string methodName(Method method) {
  return method == Method::kSlim ? "slim" : method == Method::kMls ? "mls" : "normals";
}

std::string Setting::text() const {
  char part[64];
  if (method == Method::kNormals) return "k " + std::to_string(neighbours);
  if (method == Method::kMls) {
    return "order " + std::to_string(degree) + " k " + std::to_string(neighbours);
  }
  std::string text = automatic() ? "default" : sharp ? "sharp" : "";
  if (robust) text += text.empty() ? "robust" : " robust";
  const auto add = [&](const char* name, double value) {
    std::snprintf(part, sizeof(part), "%s%s %g", text.empty() ? "" : " ", name, value);
    text += part;
  };
  if (degree > 0) add("degree", degree);
  if (penalty > 0) add("kappa", penalty);
  if (t_mdl > 0) add("T", t_mdl);
  if (compact) text += text.empty() ? "compact" : " compact";
  if (data) text += text.empty() ? "normals as data" : " normals as data";
  return text;
}

std::string Setting::fullText() const {
  return methodName(method) + " " + text() + (normals ? ", normals given" : "");
}

FitParams fitParams(const Setting& setting) {
  FitParams fit;
  fit.degree = unlessZero(setting.degree);
  fit.trim = false;  // as SLIMProjectionSmoother has it
  fit.size = PenaltyWeight{unlessZero(setting.penalty)};
  if (setting.t_mdl > 0) fit.size = MDLThreshold{setting.t_mdl};
  fit.sharp_features = setting.sharp;
  fit.robust = setting.robust;
  fit.normals_as_data = setting.data;
  if (setting.compact) fit.cover_radius = 1.0;
  fit.threads = setting.threads;
  return fit;
}

Result<Treated> treat(const Scene& scene, const Setting& setting) {
  if (Error error = checkSetting(scene, setting)) return error;
  Treated treated;
  if (setting.method == Method::kMls) {
    runMls(scene, setting, treated);
  } else if (setting.method == Method::kNormals) {
    runNormals(scene, setting, treated);
  } else if (Error error = runSlim(scene, setting, treated)) {
    return error;
  }
  return treated;
}

}  // namespace pcl_slim::comparison

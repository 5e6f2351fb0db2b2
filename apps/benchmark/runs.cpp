// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/runs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "measure/clocks.h"
#include "measure/lists.h"
#include "measure/scenes.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kLongRun = 2.0;  // seconds; chance is small beside it
constexpr double kDegreesPerRadian = 57.29577951308232;

/** Angle in radians between two directions regardless of sign; sound for the smallest angles.
 * \param[out] same_side whether they point to one side. */
double
angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool& same_side)
{
  const double dot = a.dot(b);
  same_side = dot >= 0;
  return std::atan2(a.cross(b).norm(), std::abs(dot));
}

/** Sums over points, as measure() collects them. */
struct Sums {
  double position = 0, worst = 0, normal = 0, curvature = 0, true_curvature = 0;
  std::size_t points = 0, directions = 0;

  void addPosition(double distance)
  {
    position += distance * distance;
    worst = std::max(worst, std::abs(distance));
    ++points;
  }

  void addNormal(const pcl::PointNormal& p, const measure::Truth& truth,
                 const float* mean_curvature)
  {
    bool same_side = true;
    const Eigen::Vector3d true_normal(truth.normal.data());
    const double angle =
        angleBetween(p.getNormalVector3fMap().cast<double>(), true_normal, same_side);
    normal += angle * angle;
    ++directions;
    if (mean_curvature == nullptr) return;
    const double mean = (same_side ? 1 : -1) * *mean_curvature;
    curvature += (mean - truth.mean_curvature) * (mean - truth.mean_curvature);
    true_curvature += truth.mean_curvature * truth.mean_curvature;
  }
};

}  // namespace

Errors
measure(const Scene& scene, const Treated& treated)
{
  Sums sums;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (!scene.isJudged(i)) continue;
    const pcl::PointNormal& p = treated.points[i];
    const measure::Truth truth = scene.truth(i, {p.x, p.y, p.z});
    sums.addPosition(truth.distance);
    if (!treated.done[i] || truth.rim) continue;
    sums.addNormal(p, truth, treated.mean_curvature.empty() ? nullptr : &treated.mean_curvature[i]);
  }
  Errors e;
  if (treated.moves_points && sums.points > 0) {
    e.position = std::sqrt(sums.position / static_cast<double>(sums.points)) / scene.unit;
    e.worst = sums.worst / scene.unit;
  }
  if (sums.directions == 0) return e;
  if (scene.has_true_normals) {
    e.normal = kDegreesPerRadian * std::sqrt(sums.normal / static_cast<double>(sums.directions));
  }
  if (scene.has_true_curvature && !treated.mean_curvature.empty()) {
    e.curvature = std::sqrt(sums.curvature / sums.true_curvature);
  }
  return e;
}

Errors
inputErrors(const Scene& scene)
{
  Treated untouched;
  untouched.done.assign(scene.size(), 0);
  for (const pcl::PointXYZ& p : *scene.points) {
    untouched.points.push_back(pcl::PointNormal(p.x, p.y, p.z));
  }
  return measure(scene, untouched);
}

Result<Run>
runSetting(const Scene& scene, const Setting& setting, int repeats)
{
  Run run;
  run.setting = setting;
  Result<Treated> treated = Error();
  std::vector<double> cpu, wall;
  for (int r = 0; r < std::max(1, repeats); ++r) {
    treated = Error();
    // It hands free memory back to the system: the runs after the first use theirs again.
    std::optional<measure::MemoryGauge> memory;
    if (r == 0) memory.emplace();
    treated = treat(scene, setting);
    if (!treated) return treated.error();
    cpu.push_back(treated->cpu);
    wall.push_back(treated->wall);
    if (memory) run.peak_bytes = memory->peakBytes();
    if (treated->wall > kLongRun) break;
  }
  run.cpu = measure::median(cpu);
  run.wall = measure::median(wall);
  run.errors = measure(scene, *treated);
  for (const std::uint8_t done : treated->done) run.kept += done == 0;
  return run;
}

}  // namespace pcl_slim::comparison

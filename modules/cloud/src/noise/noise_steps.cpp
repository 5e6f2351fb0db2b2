// SPDX-License-Identifier: BSD-3-Clause
// Noise of distances that a sensor rounds (docs/noise.md, "Steps"). Rounding along one direction
// puts points on parallel planes.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kPlaces = 100;      ///< number of places examined for terraces
constexpr std::size_t kPatchPoints = 20;  ///< nearest points of a place that may be on its terrace
/// Least number of these points on a plane that is a terrace, and least mean number of points of a
/// level.
constexpr std::size_t kTerracePoints = 7;
constexpr double kResolution = 1e-6;  ///< largest distance of points from their plane or level [L]
constexpr double kLeastTerraces = 0.05;  ///< least share of the places on parallel terraces
constexpr double kParallelSine = 1e-3;   ///< largest sine of the angle of two parallel terraces
constexpr std::size_t kWidePatch = 160;  ///< points of the smallest patches measured
/// Least ratio of the noise to that of rounding, (step n)^2 / 12, on patches that show all of it.
constexpr double kFullRatio = 0.9;
constexpr double kMostRatio = 2.0;  ///< largest such ratio; beyond it there is other noise

/** Points of a small patch that are on a common plane with its sample. */
struct Terrace {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< 0: there is no terrace
  std::vector<Eigen::Vector3d> points;               ///< local positions
};

/** Finds the plane through a patch's sample and two of its points that contains most of the others.
 * \param[out] most number of points on it \return its unit normal; 0: there is none */
Eigen::Vector3d fullestPlane(const Patch& patch, double resolution, std::size_t& most) {
  constexpr double kLeastSine = 0.3;
  Eigen::Vector3d fullest = Eigen::Vector3d::Zero();
  most = 0;
  const std::size_t n = patch.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d p = patch.points.at(i), q = patch.points.at(j);
      const Eigen::Vector3d normal = p.cross(q);
      if (!(normal.norm() > kLeastSine * p.norm() * q.norm())) continue;
      const Eigen::Vector3d unit = normal.normalized();
      std::size_t count = 0;
      for (std::size_t l = 0; l < n; ++l)
        count += std::abs(unit.dot(patch.points.at(l))) < resolution;
      if (count <= most) continue;
      most = count;
      fullest = unit;
    }
  }
  return fullest;
}

Terrace terraceAt(const PointStore& store, NeighborSearch& search, std::size_t sample) {
  thread_local Patch patch;
  const double resolution = kResolution * store.diagonal();
  patchAbout(store, search, sample, kPatchPoints, patch);
  Terrace terrace;
  std::size_t count = 0;
  const Eigen::Vector3d normal = fullestPlane(patch, resolution, count);
  if (count < kTerracePoints) return terrace;
  terrace.normal = normal;
  const Vector3 at = store.position(sample);
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    const Eigen::Vector3d p = patch.points.at(i);
    if (std::abs(normal.dot(p)) < resolution)
      terrace.points.emplace_back(p + Eigen::Vector3d(at[0], at[1], at[2]));
  }
  return terrace;
}

/** The terraces parallel to the one that most others are parallel to. */
std::vector<Terrace> mostParallel(const std::vector<Terrace>& terraces, double sine) {
  std::size_t most = 0, best = 0;
  const auto areParallel = [&](std::size_t i, std::size_t j) {
    return terraces[i].normal.cross(terraces[j].normal).norm() < sine;
  };
  for (std::size_t i = 0; i < terraces.size(); ++i) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < terraces.size(); ++j) count += areParallel(i, j);
    if (count <= most) continue;
    most = count;
    best = i;
  }
  std::vector<Terrace> parallel;
  for (std::size_t j = 0; j < terraces.size(); ++j) {
    if (areParallel(best, j)) parallel.push_back(terraces[j]);
  }
  return parallel;
}

Eigen::Vector3d meanNormal(const std::vector<Terrace>& parallel) {
  const Eigen::Vector3d& first = parallel.front().normal;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Terrace& terrace : parallel)
    sum += terrace.normal.dot(first) < 0 ? -terrace.normal : terrace.normal;
  return sum.normalized();
}

/** The direction along which points of one level scatter least. Terraces are of one level if their
 * coordinates along an axis differ by no more than a tolerance. */
Eigen::Vector3d commonNormal(std::vector<Terrace> terraces, const Eigen::Vector3d& axis,
                             double same) {
  const auto place = [&](const Terrace& terrace) { return axis.dot(terrace.points.front()); };
  std::sort(terraces.begin(), terraces.end(),
            [&](const Terrace& a, const Terrace& b) { return place(a) < place(b); });
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t first = 0, end = 0; first < terraces.size(); first = end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (end = first; end < terraces.size(); ++end) {
      if (end > first && place(terraces[end]) - place(terraces[end - 1]) > same) break;
      for (const Eigen::Vector3d& p : terraces[end].points) sum += p;
      count += static_cast<double>(terraces[end].points.size());
    }
    for (std::size_t t = first; t < end; ++t) {
      for (const Eigen::Vector3d& p : terraces[t].points) {
        const Eigen::Vector3d from_mean = p - sum / count;
        scatter += from_mean * from_mean.transpose();
      }
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  return axes.eigenvectors().col(0);
}

/** Finds the direction along which a sensor rounded its points: the common normal of small exactly
 * plane terraces. The cloud may have any orientation. \return nothing if few places are on
 * terraces. O(places). */
std::optional<Eigen::Vector3d> findStepAxis(const PointStore& store, int threads) {
  std::vector<Terrace> terraces(std::min(kPlaces, store.size()));
  const auto least =
      static_cast<std::size_t>(kLeastTerraces * static_cast<double>(terraces.size()));
  sampleStore(store, terraces.size(), 1, threads,
              [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
                terraces[s] = terraceAt(store, search, sample);
                return 0.0;
              });
  terraces.erase(std::remove_if(terraces.begin(), terraces.end(),
                                [](const Terrace& terrace) { return terrace.points.empty(); }),
                 terraces.end());
  if (terraces.empty() || terraces.size() < least) return {};
  const std::vector<Terrace> parallel = mostParallel(terraces, kParallelSine);
  if (parallel.size() < least) return {};
  // Distant points of one level determine the axis more exactly than a small terrace does.
  Eigen::Vector3d axis = meanNormal(parallel);
  for (const double same : {30.0, 3.0})
    axis = commonNormal(parallel, axis, same * kResolution * store.diagonal());
  return axis;
}

Eigen::Vector3d placeOf(const PointStore& store, std::size_t i) {
  const Vector3 p = store.position(i);
  return {p[0], p[1], p[2]};
}

/** The distinct coordinates of the points along an axis, ascending. */
std::vector<double> levelsOf(const PointStore& store, const Eigen::Vector3d& axis) {
  std::vector<double> values(store.size());
  for (std::size_t i = 0; i < store.size(); ++i) values[i] = axis.dot(placeOf(store, i));
  std::sort(values.begin(), values.end());
  const double same = kResolution * store.diagonal();
  const auto end = std::unique(values.begin(), values.end(),
                               [same](double a, double b) { return b - a < same; });
  values.erase(end, values.end());
  return values;
}

/** The mean step between the levels around a value. */
double stepAt(const std::vector<double>& levels, double value) {
  const auto above = std::lower_bound(levels.begin(), levels.end(), value) - levels.begin();
  const auto last = static_cast<std::ptrdiff_t>(levels.size()) - 1;
  const std::ptrdiff_t low = std::max<std::ptrdiff_t>(0, above - 2),
                       high = std::min(last, above + 2);
  return (levels[static_cast<std::size_t>(high)] - levels[static_cast<std::size_t>(low)]) /
         static_cast<double>(high - low);
}

/** Figures of a place, or their medians over places. */
struct StepRatios {
  double to_rounding = 0;  ///< noise over that of rounding; < 0: unknown
  double step = 0;         ///< step between levels [local length]
};

/** Measures the figures of one place. */
StepRatios ratiosAt(const PointStore& store, NeighborSearch& search, std::size_t sample,
                    std::size_t k, const std::vector<double>& levels, const Eigen::Vector3d& axis) {
  thread_local Patch patch;
  thread_local PatchCubic cubic;
  patchAbout(store, search, sample, k, patch);
  if (!fitCubic(patch, cubic)) return {-1, 0};
  StepRatios ratios;
  ratios.step = stepAt(levels, axis.dot(placeOf(store, sample)));
  const double along = axis.dot(principalAxes(patch.points).eigenvectors().col(0)) * ratios.step;
  ratios.to_rounding = cubic.variance * 12 / std::max(along * along, 1e-300);
  return ratios;
}

StepRatios measureRatios(const PointStore& store, const NoiseConstants& constants, std::size_t k,
                         int threads, const std::vector<double>& levels,
                         const Eigen::Vector3d& axis) {
  std::vector<StepRatios> ratios(std::min(constants.shared.places, store.size()));
  sampleStore(store, ratios.size(), 1, threads,
              [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
                ratios[s] = ratiosAt(store, search, sample, k, levels, axis);
                return 0.0;
              });
  std::vector<double> rounding, steps;
  for (const StepRatios& r : ratios) {
    if (r.to_rounding < 0) continue;
    rounding.push_back(r.to_rounding);
    steps.push_back(r.step);
  }
  if (rounding.empty()) return {};
  return {median(rounding), median(steps)};
}

}  // namespace

StepNoise measureSteps(const PointStore& store, const NoiseConstants& constants, int threads) {
  const auto axis = findStepAxis(store, resolveThreads(threads));
  if (!axis) return {};
  const std::vector<double> levels = levelsOf(store, *axis);
  if (levels.size() < 3 || levels.size() * kTerracePoints > store.size()) return {};
  const auto ratios = [&](std::size_t k) {
    return measureRatios(store, constants, k, resolveThreads(threads), levels, *axis);
  };
  std::size_t k = kWidePatch;
  StepRatios found = ratios(k);
  // Patches no wider than a terrace contain part of the rounding. On wider ones the noise is that
  // of rounding and stops growing.
  const std::size_t most = store.size() / (2 * constants.most_part);
  std::size_t wide = k;
  StepRatios wider = found;
  while (wider.to_rounding < kFullRatio && 2 * wide <= most) wider = ratios(wide *= 2);
  if (wide > k && wider.to_rounding >= kFullRatio &&
      isFlat(wider.to_rounding, ratios(2 * wide).to_rounding, constants)) {
    found = wider;
    k = wide;
  }
  if (!(found.to_rounding > 0) || found.to_rounding > kMostRatio) return {};
  return {found.step, k};
}

}  // namespace pcl_slim::detail

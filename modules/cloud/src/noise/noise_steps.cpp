// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Steps": distances that a sensor reports in steps.
#include <algorithm>
#include <cmath>

#include "noise/patch_noise.h"
#include "noise/step_axis.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

Eigen::Vector3d
placeOf(const PointStore& store, std::size_t i)
{
  const Vector3 p = store.position(i);
  return {p[0], p[1], p[2]};
}

/** The distinct places along an axis, ascending. */
std::vector<double>
levelsOf(const PointStore& store, const Eigen::Vector3d& axis, const StepConstants& constants)
{
  std::vector<double> values(store.size());
  for (std::size_t i = 0; i < store.size(); ++i) values[i] = axis.dot(placeOf(store, i));
  std::sort(values.begin(), values.end());
  const double same = constants.resolution * store.diagonal();
  const auto end = std::unique(values.begin(), values.end(),
                               [same](double a, double b) { return b - a < same; });
  values.erase(end, values.end());
  return values;
}

/** The step between the levels about a value. */
double
stepAt(const std::vector<double>& levels, double value)
{
  const auto above = std::lower_bound(levels.begin(), levels.end(), value) - levels.begin();
  const auto last = static_cast<std::ptrdiff_t>(levels.size()) - 1;
  const std::ptrdiff_t low = std::max<std::ptrdiff_t>(0, above - 2),
                       high = std::min(last, above + 2);
  return (levels[static_cast<std::size_t>(high)] - levels[static_cast<std::size_t>(low)]) /
         static_cast<double>(high - low);
}

/** Medians over places of the noise over that of rounding, and of the step. */
struct StepRatios {
  double to_rounding = 0, step = 0;
};

/** One place's. */
StepRatios
ratiosAt(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
         const std::vector<double>& levels, const Eigen::Vector3d& axis)
{
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

StepRatios
measureRatios(const PointStore& store, const NoiseConstants& constants, std::size_t k, int threads,
              const std::vector<double>& levels, const Eigen::Vector3d& axis)
{
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

StepNoise
measureSteps(const PointStore& store, const NoiseConstants& constants, int threads)
{
  const StepConstants& steps = constants.steps;
  const auto axis = findStepAxis(store, steps, resolveThreads(threads));
  if (!axis) return {};
  const std::vector<double> levels = levelsOf(store, *axis, steps);
  if (levels.size() < 3 || levels.size() * steps.terrace > store.size()) return {};
  const auto ratios = [&](std::size_t k) {
    return measureRatios(store, constants, k, resolveThreads(threads), levels, *axis);
  };
  std::size_t k = steps.wide;
  StepRatios found = ratios(k);
  // On terraces as wide as a patch rounding shows in part; where it shows in full, it grows no more.
  const std::size_t most = store.size() / (2 * constants.most_part);
  std::size_t wide = k;
  StepRatios wider = found;
  while (wider.to_rounding < steps.full_ratio && 2 * wide <= most) wider = ratios(wide *= 2);
  if (wide > k && wider.to_rounding >= steps.full_ratio &&
      isFlat(wider.to_rounding, ratios(2 * wide).to_rounding, constants)) {
    found = wider;
    k = wide;
  }
  if (!(found.to_rounding > 0) || found.to_rounding > steps.most_ratio) return {};
  return {found.step, k};
}

}  // namespace pcl_slim::detail
